#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/model/provenance.h"

namespace patchlight {

/// Rows of form factors: who sees whom. They depend on geometry and mirrors alone.
///
/// Every row is the mean of two independent halves: their difference tells how good it is.
struct TransportRows {
  /// Light that reaches a row's patch from `patch` by way of mirrors. A row's sum of these is of its whole.
  struct Mirrored {
    std::int32_t row = 0;
    std::int32_t sample_set = 0;  ///< 0 or 1.
    std::int32_t patch = 0;
    Color weight{0.0f};  ///< Form factor of this one, times what the mirrors reflect.
  };

  std::vector<std::uint64_t> starts;  ///< [2 rows + 1]: where each row's halves begin in `ends`.
  std::vector<std::int32_t> columns;  ///< The elements that a row sees; behind them, the environment's cells.
  std::vector<float> weights;         ///< Form factor of each of `ends` within its half; empty: rows by rays.
  std::vector<float> hit_weights;     ///< [2 rows], by rays: form factor of each of a half's `ends`.
  std::vector<Mirrored> mirrored;     ///< By growing row, and half.
  std::vector<float>
      visible_fractions;  ///< [2 rows] Part of each patch that is exposed, as each half has it; empty: all.
  int rays = 0;           ///< Of a row that meets something wherever it looks; 0: not by rays.

  std::int64_t rows() const { return starts.empty() ? 0 : std::int64_t(starts.size() / 2); }
};

/// The content of transport.h5: form factors of patches to patches, and what the display solution needs, so that other
/// colours and other lamps need no ray.
struct Transport : TransportRows {
  /// Form factors to an emitter that is sampled apart from the rows.
  struct Emitter {
    std::int32_t first_patch = 0;
    std::int32_t patches = 0;      ///< They emit equally.
    std::vector<float> factors;    ///< [2 n]: of both halves of each row.
    std::vector<float> display{};  ///< [2 mesh elements]: of the display mesh's; empty without one.
    /// [2 n]: as `factors`, what comes by way of mirrors, times what they reflect; empty where rows follow none.
    std::vector<Color> mirrored{};
    std::int64_t light = 0;  ///< A number for where a light without extent stands and shines; 0: a surface.
  };

  /// See Elements.
  struct Display {
    DisplayMesh mesh;
    TransportRows rows;  ///< Of the mesh's gathered vertices, to elements.
  };

  std::vector<Emitter> emitters;  ///< By growing first patch, lights without extent last.
  std::optional<Display> display;
  int sky = 0;  ///< Cells of the environment.
  std::string key;
  Provenance made;
  bool changed = false;  ///< Since it was read from a file.
};

/// What one of several tasks casts of a Transport: rows of its part of the patches, and of its part of the vertices of
/// the display mesh, numbered from its first.
struct TransportShard {
  TransportRows rows;
  std::optional<TransportRows> display_rows;  ///< Absent: no display solution was asked for.
  std::optional<DisplayMesh> mesh;            ///< Of the first shard alone, though each builds it.
  std::int64_t cast = 0;                      ///< Rays; those for the mesh count in the first.
  std::string key;
  Provenance made;
};

}  // namespace patchlight
