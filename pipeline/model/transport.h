#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/model/display_mesh.h"
#include "pipeline/model/provenance.h"

namespace patchlight {

/// Form factors as a sparse matrix in compressed sparse row (CSR) format; they depend only on geometry and mirrors.
///
/// Every row is estimated by two sample sets, A and B. Sample set s (0: A, 1: B) of row i is segment k = 2 i + s of the
/// matrix, columns[starts[k]] to columns[starts[k + 1]]. F_ij is the mean of both sets; their difference estimates its
/// standard error.
///
/// The weight of a column is its entry in `weights` (hemicubes), or, for rows by rays, `hit_weights` of its segment:
/// one column per ray that hits a lit surface, so that a column may repeat. A segment's weights and mirrored weights
/// add up to 1 minus the part that escapes, hits an unlit back, or is absorbed by mirrors.
///
/// Where rays rarely find the environment, as through a window, further rays look for it: see SkyGuide. Where they do,
/// its cells are in `sky_columns`, from sky_starts[k] to sky_starts[k + 1], with the weight `sky_weights`.
struct TransportRows {
  /// An extended form factor: light from `patch` that reaches a row over mirrors.
  struct Mirrored {
    std::int32_t row = 0;
    std::int32_t sample_set = 0;  ///< 0: A, 1: B.
    std::int32_t patch = 0;
    Color weight{0.0f};  ///< Form factor within its sample set, times the reflectance of the mirrors.
  };

  std::vector<std::uint64_t> starts;  ///< [2 rows + 1] First entry of each segment in `columns`.
  std::vector<std::int32_t> columns;  ///< Elements (see Elements); larger numbers are cells of the environment.
  std::vector<float> weights;      ///< [columns] Form factor of each column within its sample set; empty: rows by rays.
  std::vector<float> hit_weights;  ///< [2 rows] Rows by rays: form factor of every column of a segment; else empty.
  std::vector<Mirrored> mirrored;  ///< Sorted by row, then by sample set.
  /// [2 rows] Visible area fraction of each patch, in (0,1], estimated by each sample set; empty: 1 everywhere.
  std::vector<float> visible_fractions;
  int rays = 0;  ///< Rays of both sample sets of a row that hits a surface in all directions; 0: rows by hemicubes.
  std::vector<std::uint64_t> sky_starts;  ///< [2 rows + 1] First entry of each segment in `sky_columns`; empty: none.
  std::vector<std::int32_t> sky_columns;  ///< As `columns`, of the environment.
  std::vector<float> sky_weights;         ///< [2 rows] Form factor of every sky column of a segment; empty: none.

  std::int64_t rows() const { return starts.empty() ? 0 : std::int64_t(starts.size() / 2); }
};

/// Form factors to patches of emitters that are too many to be sampled individually, by samples that a LightTree chose
/// (see further_emitters()). Segments are those of TransportRows. Empty: no such emitters.
struct LightRows {
  std::vector<std::uint64_t> starts;  ///< [2 rows + 1] First entry of each segment.
  std::vector<std::int32_t> patches;
  std::vector<float> weights;  ///< Form factor within its sample set.
};

/// The content of transport.h5: form factors between patches, to explicitly sampled emitters, and of the display mesh.
/// With it, a solve with other colours or other emission casts no rays.
struct Transport : TransportRows {
  /// Form factors from every patch to an explicitly sampled emitter.
  struct Emitter {
    std::int32_t first_patch = 0;
    std::int32_t patches = 0;      ///< Number of patches, which all have the same emission.
    std::vector<float> factors;    ///< [2 rows] One per row and sample set.
    std::vector<float> display{};  ///< [2 mesh elements] For the display mesh; empty without one.
    /// [2 rows] Extended form factors over metals, times their reflectance; empty: no metals, or they are ignored.
    std::vector<Color> mirrored{};
    std::int64_t light = 0;  ///< Hash of kind, place and shape of a Light; 0: a surface.
    /// [2 rows], [2 mesh elements] What surfaces on the way let pass; empty: all of it.
    std::vector<Color> tints{}, display_tints{};

    /// Form factor of a row's sample set k, times what surfaces let pass.
    Color received(std::size_t k) const { return tints.empty() ? Color(factors[k]) : tints[k] * factors[k]; }
    Color displayed(std::size_t k) const {
      return display_tints.empty() ? Color(display[k]) : display_tints[k] * display[k];
    }
  };

  /// Form factors of the display mesh.
  struct Display {
    DisplayMesh mesh;
    TransportRows rows;  ///< From the mesh's gathered vertices to elements (see Elements).
    LightRows lights;    ///< From the mesh's gathered vertices.
  };

  std::vector<Emitter> emitters;  ///< Sorted by first patch; lights without a surface last.
  LightRows lights;
  std::int64_t lights_id = 0;  ///< Hash of the emitters of `lights`; 0: none.
  std::optional<Display> display;
  int sky = 0;  ///< Number of cells of the environment.
  std::string key;
  Provenance made;
  bool changed = false;  ///< Whether it differs from the file that it was read from.
};

/// A shard's part of a Transport: rows of its patches and of its display mesh vertices, both numbered from the shard's
/// first.
struct TransportShard {
  TransportRows rows;
  std::optional<TransportRows> display_rows;  ///< Empty: no display solution is requested.
  std::optional<DisplayMesh> mesh;            ///< In the first shard only, though every shard builds it.
  std::int64_t cast = 0;                      ///< Number of rays; the first shard counts those for the mesh.
  std::string key;
  Provenance made;
};

}  // namespace patchlight
