#pragma once
#include <hdf5.h>

#include <cstdint>
#include <utility>

namespace patchlight {

/// Owns one HDF5 identifier. Internal to pipeline/hdf5.
class H5Handle {
 public:
  using Close = herr_t (*)(hid_t);

  H5Handle() = default;
  H5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  H5Handle(H5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  H5Handle& operator=(H5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~H5Handle() { reset(); }

  /// Closes the identifier. False on failure; a failed write may be reported only here.
  bool reset() {
    const hid_t id = std::exchange(id_, -1);
    return id < 0 || close_(id) >= 0;
  }
  bool valid() const { return id_ >= 0; }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

template <class T>
hid_t h5_native_type();
template <>
inline hid_t h5_native_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t h5_native_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
inline hid_t h5_native_type<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
inline hid_t h5_native_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}

}  // namespace patchlight
