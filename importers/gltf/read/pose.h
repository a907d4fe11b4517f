#pragma once

namespace patchlight {

struct GltfModel;

/// Moves nodes, and sets the weights of morph targets, to where animations have them at `time`, s; before their first
/// and after their last keyframe as there. Throws: Error (bad_data) if keyframes have no data.
void pose_nodes(GltfModel& model, double time);

}  // namespace patchlight
