#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {

/// Text as it stands in HTML, also within quotes.
std::string html_text(const std::string& text);

/// A picture with a caption, the PNG within the page; empty if it cannot be read.
std::string html_picture(const std::filesystem::path& png, const std::string& caption);

/// A table of text cells; the first row is its head.
std::string html_table(const std::vector<std::vector<std::string>>& rows);

/// A line of a plot, by its points' place in `values`.
struct PlotLine {
  std::string name;
  std::vector<double> values;
};

/// An SVG of positive values on a logarithmic axis against their number, with a level drawn across; empty without two
/// points.
std::string html_log_plot(const std::vector<PlotLine>& lines, const std::string& across, double level,
                          const std::string& level_name);

/// A whole page that needs nothing from elsewhere.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace patchlight
