#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight::test {

struct DracoBytes {
  std::string bytes;
  std::size_t vertices = 0;  ///< That come out again.
};

/// A mesh packed by Draco; 0 bits: not quantized. In a library of its own: Draco's has a tinygltf within that must not
/// get in the way of ours.
DracoBytes draco_packed(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices, int bits);

}  // namespace patchlight::test
