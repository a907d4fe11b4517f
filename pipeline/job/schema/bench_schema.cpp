#include <algorithm>
#include <cmath>

#include "pipeline/job/schema/job_schema.h"

namespace patchlight {

namespace {

using Node = YAML::Node;

std::string key_text(const Node& key) {
  if (!key.IsScalar()) throw std::string("expected keys of the job such as solve.rays");
  return key.Scalar();
}

SweepGrid read_grid(const Node& map) {
  if (!map.IsMap() || map.size() == 0) throw std::string("expected maps such as {solve.rays: [64, 256]}");
  SweepGrid grid;
  for (const auto& entry : map) {
    SweepAxis axis{key_text(entry.first), {}};
    const Node values = entry.second.IsSequence() ? entry.second : Node(std::vector<Node>{entry.second});
    for (const Node& value : values) {
      check_setting(axis.key, value, entry.first.Mark());
      axis.values.push_back(flow_text(value));
    }
    if (axis.values.empty()) throw "expected at least one value of " + axis.key;
    grid.push_back(std::move(axis));
  }
  return grid;
}

void read_sweep(const Node& node, std::vector<SweepGrid>& sweep) {
  constexpr std::size_t kMaxVariants = 10'000;
  sweep.clear();
  if (node.IsMap())
    sweep.push_back(read_grid(node));
  else if (node.IsSequence())
    for (const Node& grid : node) sweep.push_back(read_grid(grid));
  else
    throw std::string("expected a list of maps such as {solve.rays: [64, 256]}");
  std::size_t variants = 0;
  for (const SweepGrid& grid : sweep) {
    std::size_t product = 1;
    for (const SweepAxis& axis : grid) product = std::min(product * axis.values.size(), kMaxVariants + 1);
    variants += product;
  }
  if (variants > kMaxVariants) throw "expected at most " + std::to_string(kMaxVariants) + " combinations";
}

Node sweep_node(const std::vector<SweepGrid>& sweep) {
  Node list(YAML::NodeType::Sequence);
  for (const SweepGrid& grid : sweep) {
    Node map;
    for (const SweepAxis& axis : grid)
      for (const std::string& value : axis.values) map[axis.key].push_back(YAML::Load(value));
    list.push_back(map);
  }
  return list;
}

/// A path, or a uniform radiance.
void read_reference(const Node& node, BenchConfig& bench) {
  const std::string expected = "expected the path of an EXR, or {radiance: [red, green, blue]}";
  bench.reference.clear();
  bench.radiance.reset();
  if (node.IsScalar()) {
    bench.reference = node.Scalar();
    if (bench.reference.empty()) throw expected;
    return;
  }
  if (!node.IsMap() || node.size() != 1 || !node["radiance"].IsDefined()) throw expected;
  const Node color = node["radiance"];
  if (!color.IsSequence() || color.size() != 3) throw expected;
  bench.radiance.emplace(0.0f);
  for (int k = 0; k < 3; ++k) {
    const float value = color[k].as<float>(-1.0f);
    if (!(value >= 0) || !std::isfinite(value)) throw expected + " of at least 0";
    (*bench.radiance)[k] = value;
  }
}

Node reference_node(const BenchConfig& bench) {
  if (!bench.radiance) return Node(bench.reference.string());
  Node node;
  for (int k = 0; k < 3; ++k) node["radiance"].push_back((*bench.radiance)[k]);
  return node;
}

void read_reference_settings(const Node& node, std::map<std::string, std::string>& settings) {
  if (!node.IsMap()) throw std::string("expected a map such as {solve.rays: 16384}");
  for (const auto& entry : node) {
    check_setting(key_text(entry.first), entry.second, entry.first.Mark());
    settings[key_text(entry.first)] = flow_text(entry.second);
  }
}

Node reference_settings_node(const std::map<std::string, std::string>& settings) {
  Node map(YAML::NodeType::Map);
  for (const auto& [key, value] : settings) map[key] = YAML::Load(value);
  map.SetStyle(YAML::EmitterStyle::Flow);
  return map;
}

void read_repeats(const Node& node, int& repeats) {
  const int value = node.IsScalar() ? node.as<int>(0) : 0;
  if (value < 1 || value > 1000) throw std::string("expected a whole number from 1 to 1000");
  repeats = value;
}

}  // namespace

std::vector<JobKey> bench_keys(BenchConfig& bench) {
  return {
      {"bench.sweep",
       "settings that `patchlight bench` measures: a list of maps from keys of the job to lists of values",
       [&bench](const Node& n) { read_sweep(n, bench.sweep); }, [&bench] { return sweep_node(bench.sweep); }},
      {"bench.reference", "an EXR, or {radiance: [r,g,b]} for a uniform frame; absent: a reference run",
       [&bench](const Node& n) { read_reference(n, bench); }, [&bench] { return reference_node(bench); }},
      {"bench.reference_settings", "keys of the job for the reference run, added to these",
       [&bench](const Node& n) { read_reference_settings(n, bench.reference_settings); },
       [&bench] { return reference_settings_node(bench.reference_settings); }},
      {"bench.camera", "camera of the compared frame; absent: the first",
       [&bench](const Node& n) {
         if (!n.IsScalar() || n.Scalar().empty()) throw std::string("expected the name of a camera");
         bench.camera = n.Scalar();
       },
       [&bench] { return Node(bench.camera); }},
      {"bench.repeats", "runs of each stage; the median of their CPU seconds counts",
       [&bench](const Node& n) { read_repeats(n, bench.repeats); }, [&bench] { return Node(bench.repeats); }},
  };
}

}  // namespace patchlight
