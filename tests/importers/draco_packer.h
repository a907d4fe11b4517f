#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/model/math.h"

namespace patchlight::test {

struct DracoBytes {
  std::string bytes;
  std::size_t vertices = 0;  ///< After decoding.
};

/// Encodes a mesh with Draco, positions quantized to `bits` (0: not quantized). In a separate library, since Draco's
/// contains another tinygltf.
DracoBytes draco_packed(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices, int bits);

}  // namespace patchlight::test
