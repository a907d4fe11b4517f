#pragma once
#include <string>
#include <vector>

#include "pipeline/frames/frame_list.h"

namespace patchlight {

/// The metadata of an EXR that marks a black frame.
inline constexpr const char* kBlackFrame = "patchlight:black";
/// Of a frame whose picture is all but black: the largest radiance, W/(m2 sr).
inline constexpr const char* kDarkFrame = "patchlight:nearly_black";

/// Warnings about frames as their files hold them: one for all cameras that see nothing of the scene, one for all other
/// frames that are black. Frames without a readable EXR are passed over. A scene without light has none of the latter:
/// the solve warns of it.
std::vector<std::string> frame_warnings(const Job& job, const PatchSet& scene, const std::vector<Frame>& frames);

}  // namespace patchlight
