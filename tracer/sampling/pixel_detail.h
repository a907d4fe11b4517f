#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "pipeline/model/math.h"

namespace patchlight {

/// What one path of a pixel has come to.
struct PathView {
  std::int32_t surface = -1;                             ///< A number for all that it has met, in order; -1: nothing.
  bool scattered = false;                                ///< By a rough metal.
  Vec3f normal{0.0f};                                    ///< Where it ends.
  float depth = std::numeric_limits<float>::infinity();  ///< Of what the camera sees.
  Color light{0.0f};        ///< Radiance without what emitters that are sampled apart bring it straight.
  Color reflectance{0.0f};  ///< Of all that it has met, times what comes through.
};

/// How far apart the paths of some pixels are in what they see.
class PixelDetail {
 public:
  enum class Level {
    none,  ///< As good as even, or on an even way from one pixel to the next.
    some,
    edge,  ///< Or what rough metals show, which takes as many.
  };

  void add(const PathView& path) {
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
  float farthest() const { return depth_; }

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
    /// Of the channel where it is largest: what lies between both ends over their sum, in [0,1] for what is positive.
    float contrast() const;
  };

  std::int32_t lowest_ = std::numeric_limits<std::int32_t>::max();
  std::int32_t highest_ = std::numeric_limits<std::int32_t>::min();
  float depth_ = 0.0f;
  bool scattered_ = false;
  Range normals_, light_, reflectance_;
};

}  // namespace patchlight
