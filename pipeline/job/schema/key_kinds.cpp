#include "pipeline/job/schema/key_kinds.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <regex>

#include "pipeline/job/schema/value_parsing.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

std::uint64_t parse_size(const Node& node) {
  const std::string expected = "expected a size such as 10GiB or 500MiB, or 0";
  static const std::regex size("([0-9]{1,12}(?:\\.[0-9]{1,6})?) *(?:([KMGT])(?:i?B)?|B)?");
  std::smatch parts;
  const std::string text = node.IsScalar() ? node.Scalar() : "";
  if (!std::regex_match(text, parts, size)) throw expected;
  const std::string unit = parts[2].str();
  const auto power = unit.empty() ? 0 : 1 + std::string("KMGT").find(unit);
  const double bytes = std::stod(parts[1].str()) * std::pow(1024.0, double(power));
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
