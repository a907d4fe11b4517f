#pragma once
#include <cstddef>
#include <span>

#include "importers/gltf/check/compression.h"

namespace patchlight {

/// Whether bytes begin as a stream of mode ATTRIBUTES in version 1, which only KHR_meshopt_compression has.
bool is_attributes_version_1(std::span<const unsigned char> compressed);

/// Decodes a stream of mode ATTRIBUTES in version 1, without its filter. `elements`: view.count * view.stride bytes.
/// Returns false for damaged bytes.
bool decode_attributes_version_1(const MeshoptView& view, std::span<const unsigned char> compressed,
                                 std::span<unsigned char> elements);

/// Decodes filter COLOR in place: colours of four bytes or shorts each, as the stride says. Returns false for colours
/// that no encoder writes.
bool decode_colors(const MeshoptView& view, std::span<unsigned char> elements);

}  // namespace patchlight
