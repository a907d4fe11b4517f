#include "importers/gltf/model/photometric_files.h"

#include <fmt/format.h>

#include "pipeline/job/stage_keys.h"
#include "pipeline/model/error.h"

namespace patchlight {
namespace {

std::string_view text_of(std::span<const unsigned char> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string refuse_tilt_file(const std::string& name, const std::string& where) {
  throw Error(ExitCode::bad_data, fmt::format("TILT= names the file '{}' from within the scene's file", name), where,
              "use TILT=INCLUDE or TILT=NONE");
}

}  // namespace

const PhotometricFile& PhotometricFiles::add(const std::string& key, std::string_view text, const std::string& name,
                                             const ReadTiltFile& read_tilt_file) {
  PhotometricFile file{read_photometry(text, name, read_tilt_file)};
  file.distribution = static_cast<std::int32_t>(distributions_.size());
  distributions_.push_back(std::move(file.photometry.distribution));
  return files_.emplace(key, std::move(file)).first->second;
}

const PhotometricFile& PhotometricFiles::at_uri(const std::string& uri, const std::string& where) {
  const std::string key = "uri " + uri;
  if (const auto found = files_.find(key); found != files_.end()) return found->second;
  const std::shared_ptr<const Bytes> bytes = read_uri(model_.file, uri, where);
  if (is_data_uri(uri)) {
    const std::string place = model_.file.name + ", " + where;
    return add(key, text_of(*bytes), place, [&](const std::string& tilt) { return refuse_tilt_file(tilt, place); });
  }
  return add(key, text_of(*bytes), uri, [&](const std::string& tilt) {
    const std::filesystem::path beside = std::filesystem::path(uri).parent_path() / tilt;
    return std::string(text_of(*read_uri(model_.file, beside.generic_string(), where + ", TILT= of " + uri)));
  });
}

const PhotometricFile& PhotometricFiles::of_profile(std::size_t profile) {
  const GltfData& data = model_.checked.light_profiles[profile];
  const std::string where = fmt::format("EXT_lights_ies.lights[{}] '{}'", profile, data.name);
  if (data.buffer_view < 0) return at_uri(data.uri, where);
  const std::string key = fmt::format("view {}", data.buffer_view), place = model_.file.name + ", " + where;
  if (const auto found = files_.find(key); found != files_.end()) return found->second;
  return add(key, text_of(view_bytes(model_, data.buffer_view)), place,
             [&](const std::string& tilt) { return refuse_tilt_file(tilt, place); });
}

const PhotometricFile& PhotometricFiles::of_job(const std::string& group, const std::filesystem::path& file) {
  const std::string key = "job " + file.string();
  if (const auto found = files_.find(key); found != files_.end()) return found->second;
  const std::string place = fmt::format("{}, lights.{}.ies", job_.file.string(), group);
  const auto read = [&](const std::filesystem::path& path) {
    return read_input(model_.file, path, path_beside_scene(path, job_), place);
  };
  return add(key, text_of(*read(file)), file.filename().string(), [&](const std::string& tilt) {
    return std::string(text_of(*read(file.parent_path() / confined_path(tilt, place))));
  });
}

}  // namespace patchlight
