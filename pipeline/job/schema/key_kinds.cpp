#include "pipeline/job/schema/key_kinds.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "pipeline/job/schema/value_parsing.h"
#include "pipeline/system/text_scanner.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

/// Takes the number of a size: up to 12 digits, and up to 6 decimals. Empty: there is none.
std::string take_size_number(TextScanner& text) {
  const std::string whole(text.take_digits());
  if (whole.empty() || whole.size() > 12) return "";
  if (!text.skip(".")) return whole;
  const std::string decimals(text.take_digits());
  return decimals.empty() || decimals.size() > 6 ? "" : whole + "." + decimals;
}

/// Takes a unit such as K, KB, KiB, B or none. Returns its power of 1024.
std::size_t take_size_unit(TextScanner& text) {
  static constexpr std::string_view kUnits = "KMGT";
  const std::size_t unit = text.done() ? kUnits.npos : kUnits.find(text.rest()[0]);
  if (unit == kUnits.npos) {
    text.skip("B");
    return 0;
  }
  text.skip(kUnits.substr(unit, 1));
  text.skip_any({"iB", "B"});
  return 1 + unit;
}

std::uint64_t parse_size(const Node& node) {
  const std::string expected = "expected a size such as 10GiB or 500MiB, or 0";
  TextScanner text(node.IsScalar() ? node.Scalar() : std::string_view());
  const std::string number = take_size_number(text);
  text.take([](char c) { return c == ' '; });
  const std::size_t power = take_size_unit(text);
  if (number.empty() || !text.done()) throw expected;
  const double bytes = std::stod(number) * std::pow(1024.0, double(power));
  if (bytes > 1e18) throw expected;
  return std::uint64_t(bytes);
}

std::string size_text(std::uint64_t bytes) {
  std::size_t power = 0;
  while (power < 4 && bytes > 0 && bytes % 1024 == 0) {
    bytes /= 1024;
    ++power;
  }
  return fmt::format("{}{}", bytes, std::array<const char*, 5>{"", "KiB", "MiB", "GiB", "TiB"}[power]);
}

template <class Integer>
JobKey whole_number_key(const std::string& path, Integer& value, std::int64_t low, std::int64_t high,
                        const std::string& help) {
  return {path, help, [&value, low, high](const Node& n) { value = Integer(parse_integer(n, low, high)); },
          [&value] { return Node(value); }};
}

}  // namespace

JobKey path_key(const std::string& path, std::filesystem::path& value, const std::string& help) {
  return {path, help,
          [&value](const Node& n) {
            value = parse<std::string>(n, "a path");
            if (value.empty()) throw std::string("expected a path");
          },
          [&value] { return value.empty() ? Node() : Node(value.string()); }};
}

JobKey number_key(const std::string& path, double& value, double low, double high, const std::string& help) {
  return {path, help, [&value, low, high](const Node& n) { value = parse_number(n, low, high); },
          [&value] { return number_node(value); }};
}

JobKey integer_key(const std::string& path, int& value, std::int64_t low, std::int64_t high, const std::string& help) {
  return whole_number_key(path, value, low, high, help);
}

JobKey integer_key(const std::string& path, std::int64_t& value, std::int64_t low, std::int64_t high,
                   const std::string& help) {
  return whole_number_key(path, value, low, high, help);
}

JobKey flag_key(const std::string& path, bool& value, const std::string& help) {
  return {path, help, [&value](const Node& n) { value = parse<bool>(n, "true or false"); },
          [&value] { return Node(value); }};
}

JobKey choice_key(const std::string& path, std::string& value, const std::vector<std::string>& choices,
                  const std::string& help) {
  return {path, help, [&value, choices](const Node& n) { value = parse_choice(n, choices); },
          [&value] { return Node(value); }};
}

JobKey size_key(const std::string& path, std::uint64_t& bytes, const std::string& help) {
  return {path, help, [&bytes](const Node& n) { bytes = parse_size(n); }, [&bytes] { return Node(size_text(bytes)); }};
}

}  // namespace patchlight
