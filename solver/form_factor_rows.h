#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/transport.h"
#include "solver/spectrum.h"

namespace patchlight {

/// Rows of form factors as a linear operator from radiosity to irradiance, both W/m2.
class FormFactorRows {
 public:
  /// How radiosity is kept while rows gather it; sums are in double precision always.
  enum class Precision { single, full };

  /// What a linear system's tolerance asks for.
  static Precision precision_for(double tolerance) { return tolerance < 1e-5 ? Precision::full : Precision::single; }

  /// A field that rows gather, and where to put what they receive of it.
  struct Exchange {
    const SpectrumField* radiosity = nullptr;  ///< [elements].
    SpectrumField* irradiance = nullptr;       ///< [rows], directly and by mirrors.
    SpectrumField* deviation = nullptr;        ///< [rows], if asked for: half the difference of a row's halves.
  };

  /// Fields that one pass over the rows can gather: what a pass costs is to come by an element at all.
  static constexpr int kSideBySide = 5;

  /// `sky`: cells of the environment, behind as many elements as there are rows, that rows may end on; 0: rows end on
  /// what fields have alone.
  explicit FormFactorRows(const TransportRows& rows, int sky = 0);

  /// What rows receive of up to kSideBySide fields, each of them times `factor` [elements] if there is one. Fields may
  /// leave out the environment, which is black then.
  void receive(std::span<const Exchange> fields, const SpectrumField* factor, Precision precision) const;

  /// What rows receive of `radiosity`, in full precision.
  void receive(const SpectrumField& radiosity, SpectrumField& irradiance) const;

  /// What comes by mirrors alone.
  void receive_mirrored(const SpectrumField& radiosity, SpectrumField& irradiance, SpectrumField& deviation) const;

  /// What each row sees of all elements but the environment, mirrored ones by what mirrors reflect: 1 in a closed scene
  /// without mirrors.
  SpectrumField seen() const;

 private:
  template <class Number, int kWidth>
  void receive_packed(std::span<const Exchange> fields, const SpectrumField* factor) const;

  template <class Number>
  void receive_stored(std::span<const Exchange> fields, const SpectrumField* factor) const;

  const TransportRows& transport_;
  const int sky_;
  std::vector<std::uint64_t> mirrored_starts_;  ///< [2 n + 1]; empty without mirrors.
};

}  // namespace patchlight
