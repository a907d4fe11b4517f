#include "pipeline/driver/bench/bench_variants.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>

namespace patchlight {

namespace {

/// The part after the last dot outside of quotes.
std::string last_word(const std::string& key) {
  bool quoted = false;
  std::size_t start = 0;
  for (std::size_t i = 0; i < key.size(); ++i) {
    if (key[i] == '"') quoted = !quoted;
    if (key[i] == '.' && !quoted) start = i + 1;
  }
  return key.substr(start);
}

std::string folder_name(const std::vector<SweepGrid>& sweep, const Variant& variant) {
  std::string name;
  for (const auto& [key, value] : variant.settings)
    name += (name.empty() ? "" : ",") + short_key(sweep, key) + "=" + value;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && std::string("._-=,").find(c) == std::string::npos) c = '_';
  return name.substr(0, 200);
}

}  // namespace

std::string short_key(const std::vector<SweepGrid>& sweep, const std::string& key) {
  for (const SweepGrid& grid : sweep)
    for (const SweepAxis& axis : grid)
      if (axis.key != key && last_word(axis.key) == last_word(key)) return key;
  return last_word(key);
}

std::vector<Variant> bench_variants(const std::vector<SweepGrid>& sweep) {
  std::vector<Variant> variants;
  std::set<std::string> taken{"reference"};
  for (std::size_t grid = 0; grid < sweep.size(); ++grid) {
    std::vector<std::size_t> at(sweep[grid].size(), 0);
    for (bool more = true; more;) {
      Variant variant{grid, {}, {}, {}};
      for (std::size_t k = 0; k < at.size(); ++k) {
        const SweepAxis& axis = sweep[grid][k];
        variant.settings.emplace_back(axis.key, axis.values[at[k]]);
        variant.label += (k > 0 ? ", " : "") + short_key(sweep, axis.key) + " " + axis.values[at[k]];
      }
      const std::string name = folder_name(sweep, variant);
      variant.name = name;
      for (int copy = 2; !taken.insert(variant.name).second; ++copy) variant.name = name + "_" + std::to_string(copy);
      variants.push_back(std::move(variant));
      more = false;
      for (std::size_t k = at.size(); k-- > 0 && !more;) {
        more = ++at[k] < sweep[grid][k].values.size();
        if (!more) at[k] = 0;
      }
    }
  }
  return variants;
}

std::vector<std::size_t> pareto_front(const std::vector<CostAndError>& points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(points[i].seconds) && std::isfinite(points[i].error)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(points[a].seconds, points[a].error) < std::pair(points[b].seconds, points[b].error);
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    const bool equal = !front.empty() && points[i].seconds == points[front.back()].seconds &&
                       points[i].error == points[front.back()].error;
    if (front.empty() || equal || points[i].error < points[front.back()].error) front.push_back(i);
  }
  return front;
}

}  // namespace patchlight
