#pragma once
#include <limits>

#include "pipeline/image/image_file.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// What the samples of some pixels add up to beside their beauty, as far as the layers of a job ask for it.
///
/// Light counts where the camera sees it: `specular` is all that comes by way of metals. The light of a group is that
/// at the scene's own strength, so that a frame under other settings is their sum, each times its setting.
class LayerSums {
 public:
  LayerSums(const TraceConfig& config, const PatchSet& scene, std::size_t pixels);

  bool light() const { return !emission_.empty(); }   ///< Whether light is told apart by its way.
  bool surface() const { return !albedo_.empty(); }   ///< Whether anything is asked of what is seen.
  bool groups() const { return !of_group_.empty(); }  ///< Whether it is told apart by light group.
  std::size_t group_count() const { return of_group_.size(); }

  void add_emission(std::uint32_t pixel, bool mirrored, const Color& c) { add(emission_, pixel, mirrored, c); }
  void add_direct(std::uint32_t pixel, bool mirrored, const Color& c) { add(direct_, pixel, mirrored, c); }
  void add_indirect(std::uint32_t pixel, bool mirrored, const Color& c) { add(indirect_, pixel, mirrored, c); }
  void add_of_group(std::size_t group, std::uint32_t pixel, const Color& c) { of_group_[group][pixel] += c; }

  /// The first surface that a sample meets; as it is, for one that meets none.
  struct Surface {
    float depth = 1e10f;  ///< m along the camera's axis; as Blender writes it where there is nothing.
    Vec3d position{0.0};
    Vec3f normal{0.0f};
    Color albedo{0.0f};
    std::uint32_t patch = kNoPatch;
  };
  static constexpr std::uint32_t kNoPatch = 0xffffffffu;
  /// `off`: how far from the pixel's middle, squared. Depths, places and patches have no mean: those nearest to it
  /// count.
  void add_surface(std::uint32_t pixel, const Surface& surface, float off);

  /// Layers of a whole frame, still to be filled. In the order of `config.layers`.
  static std::vector<ImageLayer> blank(const TraceConfig& config, const PatchSet& scene, std::size_t pixels);
  /// Makes pixel `at` of such layers the mean of a pixel's samples.
  void put(std::uint32_t pixel, int samples, std::size_t at, std::vector<ImageLayer>& layers) const;

 private:
  void add(std::vector<Color>& sums, std::uint32_t pixel, bool mirrored, const Color& light) {
    (mirrored ? specular_ : sums)[pixel] += light;
  }

  const TraceConfig& config_;
  std::vector<Color> emission_, direct_, indirect_, specular_;  ///< W/m2/sr.
  std::vector<Color> albedo_, normal_;
  struct Nearest {
    float off = std::numeric_limits<float>::infinity();
    float depth = 0.0f;
    Vec3f position{0.0f};
    std::uint32_t patch = kNoPatch;
  };
  std::vector<Nearest> nearest_;
  std::vector<std::vector<Color>> of_group_;  ///< [groups][pixels].
};

}  // namespace patchlight
