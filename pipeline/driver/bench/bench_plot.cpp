#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>

#include "pipeline/driver/bench/bench_report.h"
#include "pipeline/model/error.h"
#include "pipeline/system/temporary_file.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 8> kColors{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                             "#E69F00", "#56B4E9", "#7F3C8D", "#666666"};
constexpr double kSmallest = 1e-6;  // percent; an error of 0 has no place on a logarithmic axis

struct Point {
  double seconds = 0;
  double percent = 0;
  std::string label;
};

/// Points joined by one line: those of a grid that differ only in its longest axis.
struct Series {
  std::string title;
  std::vector<Point> points;
};

/// The axis of a grid that a line follows: the axis with the most values.
std::size_t running_axis(const SweepGrid& grid) {
  const auto longest = std::max_element(grid.begin(), grid.end(), [](const SweepAxis& a, const SweepAxis& b) {
    return a.values.size() < b.values.size();
  });
  return std::size_t(longest - grid.begin());
}

std::vector<Series> series_of(const std::vector<SweepGrid>& sweep, const std::vector<Measurement>& measurements) {
  std::vector<Series> series;
  std::map<std::pair<std::size_t, std::string>, std::size_t> index;
  for (const Measurement& m : measurements) {
    if (m.exit_code != 0 || !std::isfinite(m.error.block)) continue;
    const SweepGrid& grid = sweep[m.variant.grid];
    const std::size_t axis = running_axis(grid);
    std::string title;
    for (std::size_t k = 0; k < grid.size(); ++k)
      if (k != axis)
        title += (title.empty() ? "" : ", ") + short_key(sweep, grid[k].key) + " " + m.variant.settings[k].second;
    const auto [found, fresh] = index.try_emplace({m.variant.grid, title}, series.size());
    if (fresh) series.push_back({(title.empty() ? "" : title + ", ") + "by " + short_key(sweep, grid[axis].key), {}});
    series[found->second].points.push_back(
        {m.cpu_seconds(), std::max(100 * m.error.block, kSmallest), m.variant.settings[axis].second});
  }
  return series;
}

/// Text escaped for double quotes in gnuplot, without enhanced markup.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text)
    if (c == '"' || c == '\\')
      result += std::string("\\") + c;
    else if (c != '\n')
      result += c;
  return result + "\"";
}

/// Range of a logarithmic axis.
struct Range {
  double low = 0;
  double high = 0;

  double operator()(double value) const { return std::log(value / low) / std::log(high / low); }
};

Range range_of(const std::vector<Point>& points, double Point::*value) {
  const auto [least, most] = std::minmax_element(points.begin(), points.end(),
                                                 [&](const Point& a, const Point& b) { return a.*value < b.*value; });
  return {(*least).*value / 1.35, (*most).*value * 1.6};
}

/// `set` commands for an axis with tics at 1, 2 and 5 of each decade; fewer for a long axis, more for a short one.
std::string axis_commands(char axis, const Range& range) {
  const double span = range.high / range.low;
  const std::vector<double> steps = span > 2e3 ? std::vector<double>{1}
                                    : span > 9 ? std::vector<double>{1, 2, 5}
                                               : std::vector<double>{1, 1.5, 2, 3, 4, 5, 6, 8};
  std::string ticks;
  for (int decade = int(std::floor(std::log10(range.low))); decade <= int(std::ceil(std::log10(range.high))); ++decade)
    for (const double step : steps) {
      const double value = step * std::pow(10.0, decade);
      if (value < range.low || value > range.high) continue;
      ticks += fmt::format("{}\"{:.3g}\" {:.6g}", ticks.empty() ? "" : ", ", value, value);
    }
  return fmt::format("set {0}range [{1:.6g}:{2:.6g}]\nset {0}tics ({3})\n", axis, range.low, range.high, ticks);
}

/// Places labels beside their points so that they overlap neither points nor labels; a point without room gets no
/// label. Units: approximate pixels of the plot.
class LabelPlacer {
 public:
  LabelPlacer(const std::vector<Point>& points, const Range& x, const Range& y) : x_(x), y_(y) {
    for (const Point& p : points) taken_.push_back({px(p) - 4, px(p) + 4, py(p) - 4, py(p) + 4});
  }

  /// The gnuplot command of a label; empty if there is no room.
  std::string place(const Point& point, const char* color) {
    const double width = 7.0 * double(point.label.size()), height = 12, away = 7;
    for (const double side : {1.0, -1.0})
      for (const double rise : {1.0, -1.0}) {
        const double x = px(point) + side * away, y = py(point) + rise * (away + 1);
        const Box box{side > 0 ? x : x - width, side > 0 ? x + width : x, y - height / 2, y + height / 2};
        if (std::any_of(taken_.begin(), taken_.end(), [&](const Box& other) { return overlap(box, other); })) continue;
        taken_.push_back(box);
        return fmt::format("set label {} at {:.6g},{:.6g} {} offset {},{} font \",9\" tc rgb \"{}\" front\n",
                           quoted(point.label), point.seconds, point.percent, side > 0 ? "left" : "right", 0.9 * side,
                           0.5 * rise, color);
      }
    return "";
  }

 private:
  struct Box {
    double left, right, bottom, top;
  };
  static bool overlap(const Box& a, const Box& b) {
    return a.left < b.right && b.left < a.right && a.bottom < b.top && b.bottom < a.top;
  }
  double px(const Point& p) const { return 815 * x_(p.seconds); }
  double py(const Point& p) const { return 495 * y_(p.percent); }

  Range x_, y_;
  std::vector<Box> taken_;
};

std::string data_block(const std::string& name, const std::vector<Point>& points) {
  std::string text = "$" + name + " << EOD\n";
  for (const Point& p : points) text += fmt::format("{:.6g} {:.6g}\n", p.seconds, p.percent);
  return text + "EOD\n";
}

std::string script(const Job& job, const std::vector<Series>& series) {
  std::vector<Point> all, front;
  for (const Series& s : series) all.insert(all.end(), s.points.begin(), s.points.end());
  std::vector<CostAndError> points;
  for (const Point& p : all) points.push_back({p.seconds, p.percent});
  for (const std::size_t i : pareto_front(points)) front.push_back(all[i]);

  const std::size_t height = 600 + 22 * (series.size() + 1);  // the legend is below
  std::string text =
      "# Made by patchlight bench. Draw it again, in this folder: gnuplot error_against_seconds.gnuplot\n";
  text += fmt::format("set terminal pngcairo size 900,{} noenhanced font \"DejaVu Sans,11\" background \"#ffffff\"\n",
                      height);
  text +=
      "set output \"error_against_seconds.png\"\n"
      "set encoding utf8\nset logscale xy\nset border 3 lc rgb \"#555555\"\nset tics nomirror textcolor rgb "
      "\"#333333\"\n"
      "set grid xtics ytics lt 1 lw 1 lc rgb \"#e8e8e8\"\n"
      "set key below left Left reverse maxcols 1 spacing 1.25 samplen 2\n"
      "set xlabel \"CPU seconds of import, solve and trace\"\n"
      "set ylabel \"mean error of 8 x 8 pixel blocks, %\"\n";
  text += "set title " + quoted(job.file.filename().string() + ": error against time") + "\n";
  const Range x = range_of(all, &Point::seconds), y = range_of(all, &Point::percent);
  text += axis_commands('x', x) + axis_commands('y', y);
  LabelPlacer labels(all, x, y);
  for (std::size_t i = 0; i < series.size(); ++i)
    for (const Point& point : series[i].points) text += labels.place(point, kColors[i % kColors.size()]);
  text += data_block("front", front);
  for (std::size_t i = 0; i < series.size(); ++i) text += data_block(fmt::format("series{}", i), series[i].points);
  text += "plot $front using 1:2 with lines lw 9 lc rgb \"#ffe08a\" title \"Pareto front\"";
  for (std::size_t i = 0; i < series.size(); ++i)
    text += fmt::format(", \\\n  $series{} using 1:2 with linespoints pt {} ps 1.1 lw 1.6 lc rgb \"{}\" title {}", i,
                        i < kColors.size() ? 7 : 5, kColors[i % kColors.size()], quoted(series[i].title));
  return text + "\n";
}

}  // namespace

void check_gnuplot() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / "gnuplot").c_str(), X_OK) == 0) return;
  throw Error(ExitCode::unavailable, "no gnuplot to draw the plot with", "$PATH", "install it: Debian's gnuplot-nox");
}

void plot_errors(const Job& job, const std::vector<Measurement>& measurements) {
  const std::vector<Series> series = series_of(job.bench.sweep, measurements);
  if (series.empty()) return;
  const fs::path folder = bench_folder(job), file = folder / "error_against_seconds.gnuplot";
  write_text(file, script(job, series));
  std::error_code ignored;
  fs::remove(folder / "error_against_seconds.png", ignored);
  const ProgramRun run = run_program("gnuplot", {"-e", "cd " + quoted(folder.string()), file.string()});
  if (run.exit_code == int(ExitCode::interrupted)) throw Error(ExitCode::interrupted, "interrupted", "", "");
  if (run.exit_code != 0)
    throw Error(ExitCode::unavailable, "gnuplot could not draw the plot", file.string(),
                "see its message above; bench.csv holds the figures");
}

}  // namespace patchlight
