#include "pipeline/job/frame_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>

#include "pipeline/system/text_scanner.h"

namespace patchlight {

namespace {

constexpr std::size_t kLongestPart = 30;

struct Range {
  int first = 0, last = 0, step = 1;
};

/// Takes a number of one to seven digits. Returns whether there was one.
bool take_number(TextScanner& text, int& number) {
  const std::string digits(text.take_digits());
  if (digits.empty() || digits.size() > 7) return false;
  number = std::stoi(digits);
  return true;
}

/// FIRST, FIRST-LAST or FIRST-LASTxSTEP, with `..` for `-` and `:` for `x`. Returns whether `part` is one.
bool read_range(const std::string& part, Range& range) {
  TextScanner text(part);
  if (!take_number(text, range.first)) return false;
  range.last = range.first;
  if (text.done()) return true;
  if (!text.skip_any({"-", ".."}) || !take_number(text, range.last)) return false;
  return text.done() || (text.skip_any({"x", ":"}) && take_number(text, range.step) && text.done());
}

/// `part` contains no spaces.
Range parse_range(const std::string& part) {
  Range range;
  if (part.size() > kLongestPart || !read_range(part, range))
    throw "expected frames such as 1-120 or 1,5..9,20-40x2, not `" + part.substr(0, kLongestPart) + "`";
  if (range.last < range.first) throw "expected a range of frames that begins before it ends, not `" + part + "`";
  if (range.step == 0) throw "expected a step of at least 1, not `" + part + "`";
  return range;
}

}  // namespace

std::vector<int> frame_numbers(const std::string& list) {
  std::vector<int> numbers;
  std::set<int> seen;
  std::size_t count = 0;  // including duplicates, which also take time to process
  std::string plain = list + ',';
  std::erase_if(plain, [](unsigned char c) { return std::isspace(c); });
  std::istringstream parts(plain);
  for (std::string part; std::getline(parts, part, ',');) {
    const Range range = parse_range(part);
    for (int i = range.first; i <= range.last; i += range.step) {
      if (++count > kMaxFrames) throw fmt::format("expected at most {} frames", kMaxFrames);
      if (seen.insert(i).second) numbers.push_back(i);
    }
  }
  return numbers;
}

}  // namespace patchlight
