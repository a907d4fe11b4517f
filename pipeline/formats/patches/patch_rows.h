#pragma once
#include <string>
#include <vector>

#include "pipeline/hdf5/h5_store.h"

namespace patchlight {

// One row of a dataset for each of some items.

template <class T, class Entries, class Fill>
void write_rows(H5Writer& writer, const std::string& name, const Entries& items, int columns, Fill fill,
                int planes = 1) {
  const std::size_t width = columns > 0 ? std::size_t(columns) * planes : 1;
  std::vector<T> values(items.size() * width);
  for (std::size_t i = 0; i < items.size(); ++i) fill(items[i], values.data() + i * width);
  writer.dataset<T>(name, values, columns, planes);
}

template <class T, class Vector>
void put3(T* row, const Vector& v) {
  for (int k = 0; k < 3; ++k) row[k] = T(v[k]);
}

template <class Vector, class T>
Vector get3(const T* row) {
  return Vector(typename Vector::BaseType(row[0]), typename Vector::BaseType(row[1]),
                typename Vector::BaseType(row[2]));
}

template <class T, class Entries, class Fill>
void read_rows(const H5Reader& reader, const std::string& name, Entries& items, int columns, Fill fill,
               int planes = 1) {
  reader.read_into<T>(name, items, columns, fill, planes);
}

}  // namespace patchlight
