#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "pipeline/model/math.h"
#include "pipeline/optics/sampling/random.h"

namespace patchlight {

/// One number for a sequence of surfaces, with the `next` one.
inline std::int32_t combined_hash(std::int32_t surfaces, std::int32_t next) {
  return std::int32_t(std::uint32_t(hash64(std::uint64_t(std::uint32_t(surfaces)) << 32 | std::uint32_t(next))));
}

/// Features of one camera path, by which the paths of a pixel are compared.
struct PathFeatures {
  std::int32_t surface = -1;                             ///< Hash of the surfaces hit, in order; -1: none.
  bool scattered = false;                                ///< Reflected by a rough metal.
  Vec3f normal{0.0f};                                    ///< At the last surface.
  float depth = std::numeric_limits<float>::infinity();  ///< Of the first surface, along the camera's axis.
  Color light{0.0f};                                     ///< Radiance without the direct light of sampled emitters.
  Color reflectance{0.0f};  ///< Sum over the surfaces hit, each times the path's throughput.
};

/// Range of the path features of some pixels.
class PixelDetail {
 public:
  /// How much the features vary, which decides how many samples a pixel takes.
  enum class Level {
    smooth,  ///< Constant or a gradual change between pixels.
    detail,  ///< Contrast or curvature within one surface.
    edge,    ///< Several surfaces, or reflections in rough metal.
  };

  void add(const PathFeatures& path) {
    lowest_ = std::min(lowest_, path.surface);
    highest_ = std::max(highest_, path.surface);
    depth_ = std::max(depth_, path.depth);
    scattered_ = scattered_ || path.scattered;
    normals_.add(path.normal);
    light_.add(path.light);
    reflectance_.add(path.reflectance);
  }
  void add(const PixelDetail& pixel) {
    lowest_ = std::min(lowest_, pixel.lowest_);
    highest_ = std::max(highest_, pixel.highest_);
    depth_ = std::max(depth_, pixel.depth_);
    scattered_ = scattered_ || pixel.scattered_;
    normals_.add(pixel.normals_);
    light_.add(pixel.light_);
    reflectance_.add(pixel.reflectance_);
  }

  Level level() const;
  float max_depth() const { return depth_; }

 private:
  struct Range {
    Vec3f low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};

    void add(const Vec3f& v) {
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], v[k]);
        high[k] = std::max(high[k], v[k]);
      }
    }
    void add(const Range& r) {
      add(r.low);
      add(r.high);
    }
    /// Michelson contrast, (high - low) / (high + low), of the channel where it is largest; in [0,1] for positive
    /// values.
    float contrast() const;
  };

  std::int32_t lowest_ = std::numeric_limits<std::int32_t>::max();
  std::int32_t highest_ = std::numeric_limits<std::int32_t>::min();
  float depth_ = 0.0f;
  bool scattered_ = false;
  Range normals_, light_, reflectance_;
};

}  // namespace patchlight
