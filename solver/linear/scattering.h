#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "solver/linear/spectrum.h"

namespace patchlight {

/// What surfaces send out diffusely of the light that falls on them.
struct Scattering {
  /// The part of an element's irradiance that leaves `to`. What passes a surface leaves the element on its other side;
  /// a negative part takes it from the element itself.
  struct Passage {
    std::int32_t to, from;
    Spectrum part;
  };

  SpectrumField albedo;             ///< [n] What leaves the surface on either side, over the irradiance.
  std::vector<Passage> passages{};  ///< Of translucent surfaces.

  /// Radiant exitance by an irradiance, both W/m2 and [n].
  SpectrumField exitance(const SpectrumField& irradiance) const {
    SpectrumField result = irradiance;
    for (std::size_t i = 0; i < result.size(); ++i) result[i] *= albedo[i];
    for (const Passage& p : passages) result[p.to] += p.part * irradiance[p.from];
    return result;
  }
};

/// The passages to other elements, by the elements where the light comes from.
class PassagesFrom {
 public:
  explicit PassagesFrom(const Scattering& scattering) {
    for (const Scattering::Passage& p : scattering.passages)
      if (p.to != p.from) passages_.push_back(p);
    std::ranges::stable_sort(passages_, {}, &Scattering::Passage::from);
  }

  std::span<const Scattering::Passage> of(std::int32_t element) const {
    return std::ranges::equal_range(passages_, element, {}, &Scattering::Passage::from);
  }

 private:
  std::vector<Scattering::Passage> passages_;
};

}  // namespace patchlight
