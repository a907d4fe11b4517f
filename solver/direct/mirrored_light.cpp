#include "solver/direct/mirrored_light.h"

namespace patchlight {

namespace {

constexpr double kPhotonsPerRay = 0.125;  // photons of all emitters, relative to the rays of all rows

}  // namespace

MirroredLight::MirroredLight(const PatchSet& scene, const RayScene& ray_scene, const DirectFactors& direct,
                             std::uint64_t seed)
    : patches_(scene.patches.size()),
      direct_(direct),
      mirrors_(plane_mirrors(scene, ray_scene)),
      photons_(scene, ray_scene, seed, mirrors_) {}

std::vector<Color> MirroredLight::sample(const Emitter& emitter, std::size_t emitters, int rays,
                                         std::span<const float> visible_fractions, std::int64_t& cast) const {
  std::vector<Color> factors;
  if (photons_.has_paths()) {
    const double count = kPhotonsPerRay * rays * double(patches_) / double(emitters);
    factors = photons_.shoot(emitter, std::int64_t(count), cast);
    for (std::size_t k = 0; k < factors.size() && !visible_fractions.empty(); ++k) factors[k] /= visible_fractions[k];
  }
  factors.resize(mirrors_.empty() ? factors.size() : 2 * patches_, Color(0.0f));
  for (const PlaneMirror& mirror : mirrors_) {
    const std::vector<Color> image = direct_.sample_image(emitter, mirror, emitters * mirrors_.size(), rays, cast);
    for (std::size_t k = 0; k < image.size(); ++k) factors[k] += mirror.specular() * image[k];
  }
  return factors;
}

}  // namespace patchlight
