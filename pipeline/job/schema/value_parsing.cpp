#include "pipeline/job/schema/value_parsing.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <vector>

#include "pipeline/job/light_group_name.h"
#include "pipeline/job/nearest_word.h"
#include "pipeline/job/schema/job_schema.h"

namespace patchlight {

using Node = YAML::Node;

double parse_number(const Node& node, double low, double high) {
  const std::string expected = high == std::numeric_limits<double>::infinity()
                                   ? fmt::format("a number of at least {}", low)
                                   : fmt::format("a number from {} to {}", low, high);
  const double value = parse<double>(node, expected);
  if (!(value >= low && value <= high) || !std::isfinite(value)) throw "expected " + expected;
  return value;
}

std::int64_t parse_integer(const Node& node, std::int64_t low, std::int64_t high) {
  const std::string expected = fmt::format("a whole number from {} to {}", low, high);
  const std::int64_t value = parse<std::int64_t>(node, expected);
  if (value < low || value > high) throw "expected " + expected;
  return value;
}

Vec3d parse_vector(const Node& node) {
  if (!node.IsSequence() || node.size() != 3) throw std::string("expected three numbers [x, y, z]");
  constexpr double kFarthest = 1e9;
  Vec3d vector(0.0);
  for (int k = 0; k < 3; ++k) vector[k] = parse_number(node[std::size_t(k)], -kFarthest, kFarthest);
  return vector;
}

Color parse_color(const Node& node, double high) {
  if (!node.IsSequence() || node.size() != 3) throw std::string("expected three numbers [red, green, blue]");
  return Color(float(parse_number(node[0], 0, high)), float(parse_number(node[1], 0, high)),
               float(parse_number(node[2], 0, high)));
}

std::string parse_choice(const Node& node, const std::vector<std::string>& choices) {
  const std::string value = parse<std::string>(node, "a word");
  for (const auto& choice : choices)
    if (value == choice) return value;
  throw fmt::format("expected {}", fmt::join(choices, " or "));
}

std::string parse_group(const Node& node) {
  const std::string name = parse<std::string>(node, "the name of a light group");
  if (name.empty() || name.size() > kLongestLightGroup)
    throw fmt::format("expected a name of 1 to {} bytes", kLongestLightGroup);
  return light_group_name(name);
}

std::string quoted_if_dotted(const std::string& name) {
  return name.find('.') == std::string::npos ? name : '"' + name + '"';
}

void read_entries(const std::string& section, const Node& map,
                  const std::function<EntryReader(const std::string&)>& entry_reader,
                  const std::function<void(const std::string&)>& check) {
  if (!map.IsMap()) throw std::string("expected a map of names");
  for (const auto& entry : map) {
    const YAML::Mark mark = entry.first.Mark();
    if (!entry.first.IsScalar()) throw EntryFault{"a name that is not a word below `" + section + "`", "", mark};
    const std::string name = entry.first.Scalar();
    const std::string path = section + "." + quoted_if_dotted(name.substr(0, 100));
    if (!entry.second.IsMap()) throw EntryFault{"bad value of `" + path + "`", "expected a map of settings", mark};
    const EntryReader readers = entry_reader(name);
    for (const auto& setting : entry.second) {
      const std::string key = setting.first.IsScalar() ? setting.first.Scalar().substr(0, 100) : "";
      const auto reader = readers.find(key);
      if (reader == readers.end()) {
        std::vector<std::string> known;
        for (const auto& [word, unused] : readers) known.push_back(word);
        throw EntryFault{"unknown key `" + path + "." + key + "`",
                         "did you mean `" + path + "." + nearest_word(known, key) + "`?", setting.first.Mark()};
      }
      try {
        reader->second(setting.second);
      } catch (const std::string& expected) {
        throw EntryFault{"bad value of `" + path + "." + key + "`", expected, setting.first.Mark()};
      }
    }
    if (!check) continue;
    try {
      check(name);
    } catch (const std::string& mend) {
      throw EntryFault{"settings of `" + path + "` that do not go together", mend, mark};
    }
  }
}

}  // namespace patchlight
