#pragma once
#include <cmath>
#include <string>

#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/transport.h"

namespace patchlight {

/// Writes rows below `folder` but for their `exposed` and `rays`.
void write_rows(H5Writer& writer, const std::string& folder, const TransportRows& rows);

/// Reads what write_rows() wrote. `elements` that rows may end on, beside as many as there are rows if `own`. `rays` of
/// a row; 0: not by rays. Throws: Error (bad_data).
void read_rows(const H5Reader& reader, const std::string& folder, std::int64_t elements, bool own, std::int64_t rays,
               TransportRows& rows);

/// Parts of rows that are exposed; empty: all. Throws: Error (bad_data).
std::vector<float> read_visible_fractions(const H5Reader& reader, std::int64_t rows);

inline bool is_factor(float value) {
  return std::isfinite(value);
}

/// Refuses the dataset unless `good` holds for every value.
template <class Values, class Good>
void check_all(const H5Reader& reader, const std::string& dataset, const Values& values, Good good) {
  unsigned bad = 0;  // without a way out before the end it is vector code
  for (const auto value : values) bad |= unsigned(!good(value));
  if (bad > 0) reader.refuse("a value out of bounds", dataset);
}

}  // namespace patchlight
