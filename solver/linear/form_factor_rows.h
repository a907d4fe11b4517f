#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/transport.h"
#include "solver/linear/radiosity_table.h"
#include "solver/linear/scattering.h"

namespace patchlight {

/// Rows of form factors as a linear operator from radiosity to irradiance, both W/m2.
class FormFactorRows {
 public:
  using Precision = RadiosityTable::Precision;

  /// The precision that a linear system's tolerance needs.
  static Precision precision_for(double tolerance) { return tolerance < 1e-5 ? Precision::full : Precision::single; }

  /// Irradiance gathered from one field.
  struct Output {
    SpectrumField* irradiance = nullptr;  ///< [rows], with specular reflections.
    SpectrumField* deviation = nullptr;   ///< [rows] Half the difference of a row's sample sets; null: not needed.
  };
  struct Field {
    const SpectrumField* radiosity = nullptr;  ///< [elements].
    Output output;
  };

  /// `sky`: number of environment cells, which are the columns after the patches; 0: columns are those of the fields.
  explicit FormFactorRows(const TransportRows& rows, int sky = 0);

  /// Gathers each field of a table into the output of its index. Sums are always in double precision.
  void gather(const RadiosityTable& table, std::span<const Output> outputs) const;

  /// Gathers up to RadiosityTable::kMaxFields fields; with `scattering`, the exitance by each as an irradiance. Fields
  /// without values for the environment have a black one.
  void gather(std::span<const Field> fields, const Scattering* scattering, Precision precision) const;

  /// Gathers `radiosity` in full precision.
  void gather(const SpectrumField& radiosity, SpectrumField& irradiance) const;

  /// Gathers specular reflections only.
  void gather_mirrored(const SpectrumField& radiosity, SpectrumField& irradiance, SpectrumField& deviation) const;

  /// Sums of the rows' form factors without the environment, specular reflections included: 1 in a closed scene without
  /// metals.
  SpectrumField row_sums() const;

 private:
  template <class Number, int kWidth>
  void gather_packed(const RadiosityTable& table, std::span<const Output> outputs) const;

  template <class Number>
  void gather_stored(const RadiosityTable& table, std::span<const Output> outputs) const;

  const TransportRows& transport_;
  const int sky_;
  std::vector<std::uint64_t> mirrored_starts_;  ///< [2 n + 1]; empty without mirrors.
};

/// Adds the irradiance of emitters that were sampled by a LightTree, and the deviation: half the difference of a row's
/// sample sets. `emission`: [patches] W/m2. The outputs have shape [rows]; `deviation` may be null.
void gather_lights(const LightRows& lights, const SpectrumField& emission, SpectrumField& irradiance,
                   SpectrumField* deviation);

}  // namespace patchlight
