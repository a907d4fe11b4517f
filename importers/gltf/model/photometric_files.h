#pragma once
// Internal to importers/gltf: includes tinygltf.
#include <map>
#include <string>
#include <vector>

#include "importers/gltf/model/gltf_model.h"
#include "importers/photometry/photometry.h"
#include "pipeline/job/job.h"

namespace patchlight {

/// A photometric file whose distribution the scene's lights share.
struct PhotometricFile {
  Photometry photometry;          ///< Without its distribution.
  std::int32_t distribution = 0;  ///< Index into the scene's.
};

/// The photometric files of a scene and its job; each is read once.
class PhotometricFiles {
 public:
  /// Appends distributions to `distributions`, and the files that are read to the sources of `model`.
  PhotometricFiles(GltfModel& model, const Job& job, std::vector<LightDistribution>& distributions)
      : model_(model), job_(job), distributions_(distributions) {}

  // Throw: Error (missing_input, bad_data, over_limit, io_error). `where`: in the scene, for errors.

  /// By a URI relative to the scene's folder, which it must not leave.
  const PhotometricFile& at_uri(const std::string& uri, const std::string& where);

  /// By a profile of EXT_lights_ies.
  const PhotometricFile& of_profile(std::size_t profile);

  /// By the path that the job has for a light group.
  const PhotometricFile& of_job(const std::string& group, const std::filesystem::path& file);

 private:
  const PhotometricFile& add(const std::string& key, std::string_view text, const std::string& name,
                             const ReadTiltFile& read_tilt_file);

  GltfModel& model_;
  const Job& job_;
  std::vector<LightDistribution>& distributions_;
  std::map<std::string, PhotometricFile> files_;  ///< By place.
};

}  // namespace patchlight
