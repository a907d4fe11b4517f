#pragma once
#include <cmath>
#include <string>

#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/transport.h"

namespace patchlight {

/// Writes rows below the group `folder`, without visible fractions and number of rays.
void write_rows(H5Writer& writer, const std::string& folder, const TransportRows& rows);

/// Reads what write_rows() wrote. Columns must be below `elements`, plus the number of rows if `own`. `rays`: number
/// per row; 0: weights are not from ray casting. Throws: Error (bad_data).
void read_rows(const H5Reader& reader, const std::string& folder, std::int64_t elements, bool own, std::int64_t rays,
               TransportRows& rows);

/// Visible area fractions of rows; empty: all 1. Throws: Error (bad_data).
std::vector<float> read_visible_fractions(const H5Reader& reader, std::int64_t rows);

inline bool is_factor(float value) {
  return std::isfinite(value);
}

/// Refuses the dataset unless `good` holds for every value.
template <class Values, class Good>
void check_all(const H5Reader& reader, const std::string& dataset, const Values& values, Good good) {
  unsigned bad = 0;  // no early exit, so that the loop is vectorised
  for (const auto value : values) bad |= unsigned(!good(value));
  if (bad > 0) reader.refuse("a value out of bounds", dataset);
}

}  // namespace patchlight
