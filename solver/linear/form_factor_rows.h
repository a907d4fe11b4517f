#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/model/transport.h"
#include "solver/linear/radiosity_table.h"

namespace patchlight {

/// Rows of form factors as a linear operator from radiosity to irradiance, both W/m2.
class FormFactorRows {
 public:
  using Precision = RadiosityTable::Precision;

  /// What a linear system's tolerance asks for.
  static Precision precision_for(double tolerance) { return tolerance < 1e-5 ? Precision::full : Precision::single; }

  /// Where to put what rows receive of a field.
  struct Receiver {
    SpectrumField* irradiance = nullptr;  ///< [rows], directly and by mirrors.
    SpectrumField* deviation = nullptr;   ///< [rows], if asked for: half the difference of a row's halves.
  };
  /// A field that rows gather, and its receiver.
  struct Exchange {
    const SpectrumField* radiosity = nullptr;  ///< [elements].
    Receiver to;
  };

  /// `sky`: cells of the environment, behind as many elements as there are rows, that rows may end on; 0: rows end on
  /// what fields have alone.
  explicit FormFactorRows(const TransportRows& rows, int sky = 0);

  /// What rows receive of a table's fields, each to its receiver. Sums are in double precision always.
  void receive(const RadiosityTable& table, std::span<const Receiver> receivers) const;

  /// What rows receive of up to RadiosityTable::kMostFields fields, each of them times `factor` [elements] if there is
  /// one. Fields may leave out the environment, which is black then.
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
  void receive_packed(const RadiosityTable& table, std::span<const Receiver> receivers) const;

  template <class Number>
  void receive_stored(const RadiosityTable& table, std::span<const Receiver> receivers) const;

  const TransportRows& transport_;
  const int sky_;
  std::vector<std::uint64_t> mirrored_starts_;  ///< [2 n + 1]; empty without mirrors.
};

}  // namespace patchlight
