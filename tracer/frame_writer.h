#pragma once
#include "pipeline/files/frame_list.h"
#include "pipeline/files/image_file.h"
#include "pipeline/model/energy_field.h"
#include "tracer/view_transform.h"

namespace patchlight {

/// Writes frames with what they were made from in their headers.
class FrameWriter {
 public:
  /// Throws: Error (bad_config, bad_data, missing_input) for a view that cannot be had.
  FrameWriter(const Job& job, const PatchSet& scene, const EnergyField& energy);

  /// What a frame's files carry if they are what the job makes now.
  std::string key(const Frame& frame) const;

  /// Writes the PNG and then the EXR, whose header holds the PNG's hash and the frame's key: with it a frame is
  /// whole.
  /// Throws: Error (cannot_create, io_error).
  void write(const Frame& frame, Image image, double seconds) const;

 private:
  const Job& job_;
  const PatchSet& scene_;
  const EnergyField& energy_;
  ViewTransform view_;
  std::string view_config_;          ///< Its key.
  mutable double cpu_before_ = 0.0;  ///< Of the process, when it wrote the last frame, s.
};

}  // namespace patchlight
