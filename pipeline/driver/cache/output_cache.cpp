#include "pipeline/driver/cache/output_cache.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "pipeline/driver/cache/freshness.h"
#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"
#include "pipeline/system/content_hash.h"
#include "pipeline/system/temporary_file.h"
#include "pipeline/system/text_scanner.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

/// Sets the access time, which orders entries by their last use.
void touch(const fs::path& file) {
  const timespec times[2]{{0, UTIME_NOW}, {0, UTIME_OMIT}};
  utimensat(AT_FDCWD, file.c_str(), times, 0);
}

/// Replaces `to` by a hard link to `from`. Returns whether this succeeded.
bool link_over(const fs::path& from, const fs::path& to) {
  std::error_code fault;
  if (!fs::is_regular_file(from, fault)) return false;
  if (fs::equivalent(from, to, fault)) return true;
  try {
    TemporaryFile name(to);
    fs::create_hard_link(from, name.path(), fault);
    if (fault) return false;
    name.commit();
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Skips a hyphen and a key. Returns whether they follow.
bool skip_key(TextScanner& text) {
  constexpr std::size_t kDigits = 32;
  return text.skip("-") &&
         text.take([](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }).size() == kDigits;
}

/// Whether a name has the form patches-HASH-KEY.EXTENSION, or OUTPUT-KEY.EXTENSION for other outputs.
bool is_kept_name(const std::string& name) {
  TextScanner text(name);
  const bool named = text.skip("patches") ? skip_key(text) : text.skip_any({"energy", "transport", "frame"});
  return named && skip_key(text) && text.skip_any({".h5", ".exr", ".png"}) && text.done();
}

/// Entries of the cache, recognized by their names; other files are left alone.
std::vector<fs::path> kept_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code fault;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault))
    if (is_kept_name(entry->path().filename().string())) files.push_back(entry->path());
  return files;
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
  remove_beyond(limit_);
}

std::uint64_t OutputCache::clear() const {
  const std::uint64_t freed = remove_beyond(0);
  std::error_code fault;
  for (const fs::path& file : kept_files(folder_)) fs::remove(file, fault);
  fs::remove(folder_, fault);
  return freed;
}

std::uint64_t OutputCache::remove_beyond(std::uint64_t limit) const {
  std::vector<std::tuple<std::int64_t, std::int64_t, fs::path, std::uint64_t>> alone;  // last use in s and ns, size
  std::uint64_t total = 0, freed = 0;
  for (const fs::path& file : kept_files(folder_)) {
    struct stat info;
    if (::lstat(file.c_str(), &info) != 0 || !S_ISREG(info.st_mode) || info.st_nlink > 1) continue;
    alone.emplace_back(info.st_atim.tv_sec, info.st_atim.tv_nsec, file, std::uint64_t(info.st_size));
    total += std::uint64_t(info.st_size);
  }
  std::sort(alone.begin(), alone.end());
  std::error_code fault;
  for (const auto& [seconds, nanoseconds, file, size] : alone)
    if (total - freed > limit && fs::remove(file, fault)) freed += size;
  return freed;
}

void OutputCache::keep_patches(const Job& job, const PatchSet& scene) const {
  keep(job.patch_file(), patches_prefix(scene.sources.at(0).hash) + scene.inputs_key + ".h5");
}

bool OutputCache::restore_patches(const Job& job) const {
  std::error_code fault;
  if (limit_ == 0 || !fs::is_regular_file(job.scene, fault)) return false;
  const std::string prefix = patches_prefix(hash_file(job.scene));
  for (const fs::path& file : kept_files(folder_)) {
    if (!file.filename().string().starts_with(prefix)) continue;
    try {
      const std::string key = import_key(job, read_patches(file).sources);
      return !key.empty() && restore(prefix + key + ".h5", job.patch_file());
    } catch (const Error&) {  // damaged: try the next
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
