#pragma once
#include <string>
#include <vector>

namespace patchlight {

/// Maximum number of frames of a job.
constexpr std::size_t kMaxFrames = 100'000;

/// Frame numbers of a list of frames and ranges, in its order without duplicates: `7`, `1-120`, `1,5..9`,
/// `3, 5-10, 47-327`, and with a step `1-120x10` or `1..120:10`. Numbers have up to seven digits.
/// Throws: std::string, the expected format.
std::vector<int> frame_numbers(const std::string& list);

}  // namespace patchlight
