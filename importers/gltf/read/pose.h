#pragma once

namespace patchlight {

struct GltfModel;

/// Sets node transforms and morph target weights to their animated values at `time`, s, clamped to the first and last
/// keyframes. Throws: Error (bad_data) for keyframes without data or with non-finite values.
void pose_nodes(GltfModel& model, double time);

}  // namespace patchlight
