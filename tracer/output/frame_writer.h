#pragma once
#include <map>
#include <string>

#include "pipeline/frames/frame_list.h"
#include "pipeline/image/image_file.h"
#include "pipeline/model/energy_field.h"
#include "tracer/output/view_transform.h"

namespace patchlight {

/// Writes frames with their provenance in the file headers.
class FrameWriter {
 public:
  /// Throws: Error (bad_config, bad_data, missing_input) if the view cannot be loaded.
  FrameWriter(const Job& job, const PatchSet& scene, std::string energy_key);

  /// States the solution's error in the headers of the frames.
  void state_error(const EnergyField::Estimate& estimate);

  /// Key that the frame's files hold while they are up to date.
  std::string key(const Frame& frame) const;

  /// Writes the PNG, then the EXR, whose header holds the hash of the PNG and the frame's key and so completes the
  /// frame. `seconds`: render time. `relit_from`: key of the traced frame that a relit frame was made from; empty for a
  /// traced frame.
  /// Throws: Error (cannot_create, io_error).
  void write(const Frame& frame, Image image, double seconds, const std::string& relit_from = "") const;

 private:
  const Job& job_;
  const PatchSet& scene_;
  std::string energy_key_;
  ViewTransform view_;
  std::map<std::string, std::string> stated_errors_;  ///< Attributes of the header.
  std::string view_config_;                           ///< Key of the OpenColorIO config.
  mutable double last_cpu_seconds_ = 0.0;             ///< CPU time of the process when it wrote the previous frame.
};

}  // namespace patchlight
