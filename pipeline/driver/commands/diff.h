#pragma once
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace patchlight {

struct DiffCommand {
  std::string a;
  std::string b;
  /// Each a number from 0 up, or such a number for datasets or layers of a name: GLOB=NUMBER; the last that fits
  /// counts.
  std::vector<std::string> tolerance;  ///< What none fits: no difference, or any beside a `max`.
  std::vector<std::string> max;
};

/// Prints how two files of one kind differ. Returns 1 if by more than is allowed, else 0.
/// Throws: Error (usage) for a malformed limit, (missing_input, bad_data).
int compare_files(const DiffCommand& command);

}  // namespace patchlight
