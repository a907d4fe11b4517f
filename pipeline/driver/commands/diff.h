#pragma once
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct DiffCommand {
  std::string a;
  std::string b;
  /// Numbers of at least 0, or GLOB=NUMBER for matching datasets or layers; the last match counts.
  std::vector<std::string> tolerance;  ///< Without a match: no difference is allowed, or any with a `max`.
  std::vector<std::string> max;
};

/// Prints the differences of two files of one kind. Returns 1 if they exceed a limit, else 0.
/// Throws: Error (usage) for a malformed limit, (missing_input, bad_data).
int compare_files(const DiffCommand& command);

}  // namespace patchlight
