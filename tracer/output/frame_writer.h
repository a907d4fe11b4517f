#pragma once
#include "pipeline/frames/frame_list.h"
#include "pipeline/image/image_file.h"
#include "tracer/output/view_transform.h"

namespace patchlight {

/// Writes frames with what they were made from in their headers.
class FrameWriter {
 public:
  /// Throws: Error (bad_config, bad_data, missing_input) for a view that cannot be had.
  FrameWriter(const Job& job, const PatchSet& scene, std::string energy_key);

  /// What a frame's files carry if they are what the job makes now.
  std::string key(const Frame& frame) const;

  /// Writes the PNG and then the EXR, whose header holds the PNG's hash and the frame's key: with it a frame is
  /// whole. `relit_from`: the key of the frame that it was made of without a trace, which its own key tells it from;
  /// empty: it was traced.
  /// Throws: Error (cannot_create, io_error).
  void write(const Frame& frame, Image image, double seconds, const std::string& relit_from = "") const;

 private:
  const Job& job_;
  const PatchSet& scene_;
  std::string energy_key_;
  ViewTransform view_;
  std::string view_config_;          ///< Its key.
  mutable double cpu_before_ = 0.0;  ///< Of the process, when it wrote the last frame, s.
};

}  // namespace patchlight
