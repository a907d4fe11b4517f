#pragma once
#include <limits>

#include "pipeline/image/image_file.h"
#include "pipeline/job/job.h"
#include "pipeline/model/patch_set.h"
#include "tracer/output/seen_by.h"

namespace patchlight {

/// Sums over the samples of some pixels, for the layers that a job asks for.
///
/// Light belongs to the layer of the first surface: `specular` holds all light that reaches the camera by specular
/// reflection and by glass that turns it, `metal`, `coat` and `transmission` its parts. Light groups are stored at the
/// scene's own strength, so the sum of all groups, each times its setting, is the frame under these settings.
class LayerSums {
 public:
  LayerSums(const TraceConfig& config, const PatchSet& scene, std::size_t pixels);

  bool has_light() const { return !emission_.empty(); }   ///< Light by transport path is asked for.
  bool has_surfaces() const { return !albedo_.empty(); }  ///< Data of the first surface are asked for.
  bool has_groups() const { return !by_group_.empty(); }  ///< Light by light group is asked for.
  std::size_t group_count() const { return by_group_.size(); }

  void add_emission(std::uint32_t pixel, SeenBy by, const Color& c) { add(emission_, pixel, by, c); }
  void add_direct(std::uint32_t pixel, SeenBy by, const Color& c) { add(direct_, pixel, by, c); }
  void add_indirect(std::uint32_t pixel, SeenBy by, const Color& c) { add(indirect_, pixel, by, c); }
  void add_to_group(std::size_t group, std::uint32_t pixel, const Color& c) { by_group_[group][pixel] += c; }

  /// First surface that a sample hits; the defaults stand for a miss.
  struct Surface {
    float depth = 1e10f;  ///< m along the camera's axis; 1e10 for a miss, as in Blender.
    Vec3d position{0.0};
    Vec3f normal{0.0f};
    Color albedo{0.0f};
    std::uint32_t patch = kNoPatch;
  };
  static constexpr std::uint32_t kNoPatch = 0xffffffffu;
  /// `distance2`: squared distance of the sample from the pixel's centre. Depth, position and patch are not averaged:
  /// the sample nearest to the centre counts.
  void add_surface(std::uint32_t pixel, const Surface& surface, float distance2);
  /// Sets depth, position and patch alone, until a nearer sample is added.
  void set_surface(std::uint32_t pixel, const Surface& surface);

  /// Zero-filled layers of a whole frame, in the order of `config.layers`.
  static std::vector<ImageLayer> blank(const TraceConfig& config, const PatchSet& scene, std::size_t pixels);
  /// Sets pixel `at` of the frame's layers to the mean of the pixel's samples.
  void resolve(std::uint32_t pixel, int samples, std::size_t at, std::vector<ImageLayer>& layers) const;

 private:
  void add(std::vector<Color>& sums, std::uint32_t pixel, SeenBy by, const Color& light) {
    (by == SeenBy::itself ? sums : by == SeenBy::metal ? metal_ : by == SeenBy::coat ? coat_ : glass_)[pixel] += light;
  }

  const TraceConfig& config_;
  std::vector<Color> emission_, direct_, indirect_, metal_, coat_, glass_;  ///< W/m2/sr.
  std::vector<Color> albedo_, normal_;
  struct Nearest {
    float distance2 = std::numeric_limits<float>::infinity();
    float depth = 0.0f;
    Vec3f position{0.0f};
    std::uint32_t patch = kNoPatch;
  };
  std::vector<Nearest> nearest_;
  std::vector<std::vector<Color>> by_group_;  ///< [groups][pixels].
};

}  // namespace patchlight
