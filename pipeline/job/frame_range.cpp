#include "pipeline/job/frame_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>
#include <sstream>

namespace patchlight {

namespace {

constexpr std::size_t kLongestPart = 30;

struct Range {
  int first = 0, last = 0, step = 1;
};

/// `part` has no spaces.
Range parse_range(const std::string& part) {
  static const std::regex pattern(R"((\d{1,7})(?:(?:-|\.\.)(\d{1,7})(?:[x:](\d{1,7}))?)?)");
  std::smatch match;
  if (part.size() > kLongestPart || !std::regex_match(part, match, pattern))
    throw "expected frames such as 1-120 or 1,5..9,20-40x2, not `" + part.substr(0, kLongestPart) + "`";
  Range range;
  range.first = range.last = std::stoi(match[1]);
  if (match[2].matched) range.last = std::stoi(match[2]);
  if (match[3].matched) range.step = std::stoi(match[3]);
  if (range.last < range.first) throw "expected a range of frames that begins before it ends, not `" + part + "`";
  if (range.step == 0) throw "expected a step of at least 1, not `" + part + "`";
  return range;
}

}  // namespace

std::vector<int> frame_numbers(const std::string& list) {
  std::vector<int> numbers;
  std::set<int> seen;
  std::size_t count = 0;  // with those that stand there twice, which take their time too
  std::string plain = list + ',';
  std::erase_if(plain, [](unsigned char c) { return std::isspace(c); });
  std::istringstream parts(plain);
  for (std::string part; std::getline(parts, part, ',');) {
    const Range range = parse_range(part);
    for (int i = range.first; i <= range.last; i += range.step) {
      if (++count > kMostFrames) throw fmt::format("expected at most {} frames", kMostFrames);
      if (seen.insert(i).second) numbers.push_back(i);
    }
  }
  return numbers;
}

}  // namespace patchlight
