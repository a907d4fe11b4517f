#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {

/// Text escaped for HTML, also for quoted attributes.
std::string html_text(const std::string& text);

/// A figure with a caption and an embedded PNG; empty if the file cannot be read.
std::string html_picture(const std::filesystem::path& png, const std::string& caption);

/// A table of text cells; the first row is the header.
std::string html_table(const std::vector<std::vector<std::string>>& rows);

/// One line of a plot: values at x = 0, 1, 2, ...
struct PlotLine {
  std::string name;
  std::vector<double> values;
};

/// An SVG plot of positive values on a logarithmic y axis against their index, with a horizontal line at `level`; empty
/// with fewer than two points. `across`: label of the x axis.
std::string html_log_plot(const std::vector<PlotLine>& lines, const std::string& across, double level,
                          const std::string& level_name);

/// A complete, self-contained page.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace patchlight
