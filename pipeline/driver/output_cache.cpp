#include "pipeline/driver/output_cache.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "pipeline/driver/freshness.h"
#include "pipeline/files/key.h"
#include "pipeline/files/patch_file.h"
#include "pipeline/files/temporary_file.h"
#include "pipeline/model/error.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

/// The times of access order what is kept by its last use.
void touch(const fs::path& file) {
  const timespec times[2]{{0, UTIME_NOW}, {0, UTIME_OMIT}};
  utimensat(AT_FDCWD, file.c_str(), times, 0);
}

/// Makes `to` another name of `from`, whatever stood there. Returns whether it could.
bool link_over(const fs::path& from, const fs::path& to) {
  std::error_code fault;
  if (!fs::is_regular_file(from, fault)) return false;
  if (fs::equivalent(from, to, fault)) return true;
  TemporaryFile name(to);
  fs::create_hard_link(from, name.path(), fault);
  if (fault) return false;
  name.commit();
  return true;
}

std::string patches_prefix(const std::string& scene_hash) {
  return "patches-" + scene_hash + "-";
}

std::string energy_name(const std::string& key) {
  return "energy-" + key + ".h5";
}

std::string transport_name(const std::string& key) {
  return "transport-" + key + ".h5";
}

}  // namespace

OutputCache::OutputCache(fs::path folder, std::uint64_t limit) : folder_(std::move(folder)), limit_(limit) {}

void OutputCache::keep(const fs::path& file, const std::string& name) const {
  if (limit_ > 0 && link_over(file, folder_ / name)) touch(folder_ / name);
}

bool OutputCache::restore(const std::string& name, const fs::path& file) const {
  if (limit_ == 0 || !link_over(folder_ / name, file)) return false;
  touch(file);
  return true;
}

void OutputCache::trim() const {
  std::vector<std::tuple<std::int64_t, std::int64_t, fs::path>> kept;  // last use in s and ns
  std::vector<std::uint64_t> sizes;
  std::uint64_t total = 0;
  std::error_code fault;
  for (fs::directory_iterator entry(folder_, fault), end; !fault && entry != end; entry.increment(fault)) {
    struct stat info;
    if (::lstat(entry->path().c_str(), &info) != 0 || !S_ISREG(info.st_mode) || info.st_nlink > 1) continue;
    total += std::uint64_t(info.st_size);
    kept.emplace_back(info.st_atim.tv_sec, info.st_atim.tv_nsec, entry->path());
  }
  std::sort(kept.begin(), kept.end());
  for (const auto& [seconds, nanoseconds, file] : kept) {
    if (total <= limit_) return;
    const std::uintmax_t size = fs::file_size(file, fault);
    if (fs::remove(file, fault) && !fault) total -= size;
  }
}

void OutputCache::keep_patches(const Job& job, const PatchSet& scene) const {
  keep(job.patch_file(), patches_prefix(scene.sources.at(0).hash) + scene.inputs_key + ".h5");
}

bool OutputCache::restore_patches(const Job& job) const {
  std::error_code fault;
  if (limit_ == 0 || !fs::is_regular_file(job.scene, fault)) return false;
  const std::string prefix = patches_prefix(hash_file(job.scene));
  for (fs::directory_iterator entry(folder_, fault), end; !fault && entry != end; entry.increment(fault)) {
    if (!entry->path().filename().string().starts_with(prefix)) continue;
    try {
      const std::string key = import_key(job, read_patches(entry->path()).sources);
      return !key.empty() && restore(prefix + key + ".h5", job.patch_file());
    } catch (const Error&) {  // damaged: another may tell
    }
  }
  return false;
}

void OutputCache::keep_energy(const Job& job, const PatchSet& scene) const {
  keep(job.energy_file(), energy_name(energy_key(scene.key, job.solve)));
  if (keeps_transport(job, scene))
    keep(job.transport_file(), transport_name(transport_key(scene.geometry_key, job.solve)));
}

bool OutputCache::restore_energy(const Job& job, const PatchSet& scene) const {
  if (keeps_transport(job, scene))
    restore(transport_name(transport_key(scene.geometry_key, job.solve)), job.transport_file());
  return restore(energy_name(energy_key(scene.key, job.solve)), job.energy_file());
}

void OutputCache::keep_frame(const Frame& frame, const std::string& key) const {
  keep(frame.png, "frame-" + key + ".png");
  keep(frame.exr, "frame-" + key + ".exr");
}

bool OutputCache::restore_frame(const Frame& frame, const std::string& key) const {
  return restore("frame-" + key + ".png", frame.png) && restore("frame-" + key + ".exr", frame.exr);
}

fs::path cache_folder(const Job& job) {
  return job.output / "cache";
}

}  // namespace patchlight
