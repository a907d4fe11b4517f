#include "pipeline/driver/clean/own_files.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>

#include "pipeline/formats/solution/transport_shard_file.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/image/image_file.h"
#include "pipeline/job/job.h"
#include "pipeline/model/error.h"
#include "pipeline/system/temporary_file.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

/// Regular files in a folder, and links to them.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code fault, ignored;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault))
    if (entry->is_regular_file(ignored)) files.push_back(entry->path());
  return files;
}

std::string first_bytes(const fs::path& file, std::size_t count) {
  std::string bytes(count, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), std::streamsize(count));
  bytes.resize(std::size_t(stream.gcount()));
  return bytes;
}

/// Whether a file is readable HDF5 in a format of Patchlight.
bool is_own_h5(const fs::path& file) {
  try {
    return h5_format(file).starts_with("patchlight-");
  } catch (const Error&) {
    return false;
  }
}

bool is_own_frame(const fs::path& file) {
  try {
    return file.extension() == ".exr" && read_exr_header(file).metadata.contains("patchlight:key");
  } catch (const Error&) {
    return false;
  }
}

void add_frames(const fs::path& folder, std::vector<fs::path>& own) {
  for (const fs::path& file : files_in(folder)) {
    if (!is_own_frame(file)) continue;
    own.push_back(file);
    const fs::path png = fs::path(file).replace_extension(".png");
    if (std::error_code fault; fs::is_regular_file(png, fault)) own.push_back(png);
  }
}

}  // namespace

std::vector<fs::path> own_stage_files(const fs::path& output) {
  Job job;
  job.output = output;
  std::vector<fs::path> named = transport_shard_files(job), own;
  for (const fs::path& file : {job.patch_file(), job.transport_file(), job.energy_file()}) named.push_back(file);
  std::error_code fault;
  for (const fs::path& file : named)
    if (fs::is_regular_file(file, fault) && is_own_h5(file)) own.push_back(file);
  for (const fs::path& folder : {job.frame_folder(), job.relit_folder()}) add_frames(folder, own);
  for (const fs::path& folder : {output, job.frame_folder(), job.relit_folder(), output / "preview", output / "cache"})
    for (const fs::path& file : files_in(folder))
      if (file.filename().string().starts_with(kTemporaryPrefix)) own.push_back(file);
  return own;
}

std::vector<fs::path> own_previews(const fs::path& folder) {
  static constexpr std::array kKinds{"patches", "radiosity", "irradiance", "hemicube"};
  std::vector<fs::path> own;
  for (const fs::path& file : files_in(folder)) {
    const std::string name = file.filename().string();
    const auto names_it = [&](const char* kind) { return name.starts_with(std::string(kind) + "."); };
    if (file.extension() == ".png" && std::any_of(kKinds.begin(), kKinds.end(), names_it) &&
        first_bytes(file, 4) == "\x89PNG")
      own.push_back(file);
  }
  return own;
}

bool is_own_report(const fs::path& file) {
  const std::string head = first_bytes(file, 1024);
  const std::size_t title = head.find("<title>");
  return head.starts_with("<!DOCTYPE html>") && title != std::string::npos &&
         head.substr(title, head.find("</title>") - title).find(", patchlight ") != std::string::npos;
}

bool is_own_bench(const fs::path& file) {
  return first_bytes(file, 64).find("\"patchlight-bench\"") != std::string::npos;
}

std::size_t count_files(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code fault, ignored;
  for (fs::recursive_directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault))
    count += !fs::is_directory(entry->symlink_status(ignored));
  return count;
}

}  // namespace patchlight
