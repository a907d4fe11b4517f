#include "solver/progress/solve_parts.h"

#include <array>

namespace patchlight {

void begin_part(SolvePart part, const SolveConfig& config, Progress& progress) {
  // Over the time of a whole solve: estimates by the numbers of rays of a room with furniture and lamps.
  constexpr double kDirect = 0.40, kLinear = 0.46, kDisplay = 0.52, kDisplayLight = 0.92;
  constexpr std::array<std::array<double, 2>, 6> kParts{{{0, kDirect},
                                                         {kDirect, kLinear},
                                                         {kLinear, kDisplay},
                                                         {0, kDisplay},
                                                         {kDisplay, kDisplayLight},
                                                         {kDisplayLight, 1}}};
  const auto& [begin, end] = kParts[int(part)];
  const double whole = config.display ? 1.0 : kDisplay;
  progress.set_part(begin / whole, end / whole);
}

}  // namespace patchlight
