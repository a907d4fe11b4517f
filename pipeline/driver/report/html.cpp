#include "pipeline/driver/report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>

namespace patchlight {

namespace {

constexpr std::array<const char*, 8> kColors{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                             "#E69F00", "#56B4E9", "#7F3C8D", "#666666"};

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// Maps plot values to pixels.
struct Axes {
  static constexpr int kLeft = 70, kTop = 16, kWidth = 560, kHeight = 220;
  double low = 0, high = 0;  ///< Decades.
  std::size_t last = 1;

  double x(double i) const { return kLeft + kWidth * i / double(last); }
  double y(double value) const { return kTop + kHeight * (high - std::log10(value)) / (high - low); }
};

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>\n", x, y, anchor, html_text(text));
}

std::string grid(const Axes& axes, const std::string& across) {
  std::string svg;
  const int step = std::max(1, int(axes.high - axes.low) / 6);
  for (int decade = int(axes.low); decade <= int(axes.high); decade += step) {
    const double y = axes.y(std::pow(10.0, decade));
    svg += fmt::format("<line class='grid' x1='{}' y1='{:.1f}' x2='{}' y2='{:.1f}'/>\n", Axes::kLeft, y,
                       Axes::kLeft + Axes::kWidth, y);
    svg += text_at(Axes::kLeft - 8, y + 4, "end", fmt::format("1e{}", decade));
  }
  const std::size_t stride = (axes.last + 9) / 10;
  for (std::size_t i = 0; i <= axes.last; i += stride)
    svg += text_at(axes.x(double(i)), Axes::kTop + Axes::kHeight + 16, "middle", fmt::format("{}", i));
  return svg + text_at(Axes::kLeft + 0.5 * Axes::kWidth, Axes::kTop + Axes::kHeight + 34, "middle", across);
}

}  // namespace

std::string html_text(const std::string& text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  return result;
}

std::string html_picture(const std::filesystem::path& png, const std::string& caption) {
  std::ifstream stream(png, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (bytes.empty()) return "";
  return fmt::format("<figure><img alt=\"{}\" src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
                     html_text(png.filename().string()), base64(bytes), html_text(caption));
}

std::string html_table(const std::vector<std::vector<std::string>>& rows) {
  std::string table = "<table>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    table += "<tr>";
    for (const std::string& cell : rows[i])
      table += fmt::format("<{0}>{1}</{0}>", i == 0 ? "th" : "td", html_text(cell));
    table += "</tr>\n";
  }
  return table + "</table>\n";
}

std::string html_log_plot(const std::vector<PlotLine>& lines, const std::string& across, double level,
                          const std::string& level_name) {
  double low = level, high = level;
  Axes axes;
  axes.last = 0;
  for (const PlotLine& line : lines) {
    axes.last = std::max(axes.last, line.values.empty() ? 0 : line.values.size() - 1);
    for (const double value : line.values)
      if (value > 0 && std::isfinite(value)) {
        low = std::min(low, value);
        high = std::max(high, value);
      }
  }
  if (axes.last == 0 || !(low > 0)) return "";
  axes.low = std::floor(std::log10(low));
  axes.high = std::max(std::ceil(std::log10(high)), axes.low + 1);
  std::string svg = fmt::format("<svg viewBox='0 0 820 {0}' width='820' height='{0}' role='img'>\n",
                                Axes::kTop + Axes::kHeight + 44) +
                    grid(axes, across);
  svg += fmt::format("<line class='level' x1='{}' y1='{:.1f}' x2='{}' y2='{:.1f}'/>\n", Axes::kLeft, axes.y(level),
                     Axes::kLeft + Axes::kWidth, axes.y(level));
  svg += text_at(Axes::kLeft + Axes::kWidth + 8, axes.y(level) + 4, "start", level_name);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const char* color = kColors[k % kColors.size()];
    std::string points;
    for (std::size_t i = 0; i < lines[k].values.size(); ++i)
      if (lines[k].values[i] > 0 && std::isfinite(lines[k].values[i]))
        points += fmt::format("{:.1f},{:.1f} ", axes.x(double(i)), axes.y(lines[k].values[i]));
    svg += fmt::format("<polyline fill='none' stroke='{}' stroke-width='2' points='{}'/>\n", color, points);
    if (k >= kColors.size()) continue;  // the legend has no room for more
    const double y = Axes::kTop + 14 + 18 * double(k);
    svg += fmt::format("<rect x='{}' y='{:.1f}' width='12' height='4' fill='{}'/>\n", Axes::kLeft + Axes::kWidth - 150,
                       y - 6, color);
    svg += text_at(Axes::kLeft + Axes::kWidth - 132, y, "start", lines[k].name);
  }
  return svg + "</svg>\n";
}

std::string html_page(const std::string& title, const std::string& body) {
  static constexpr const char* kStyle =
      "body{font:15px/1.45 system-ui,sans-serif;color:#222;background:#fafaf8;max-width:1120px;margin:2em auto;"
      "padding:0 1em}h1{font-size:1.6em}h2{font-size:1.25em;margin-top:2em;border-bottom:1px solid #ccc}"
      "h3{font-size:1.05em;margin:1.4em 0 .4em}table{border-collapse:collapse;margin:.5em 0}"
      "td,th{padding:.25em .9em .25em 0;text-align:left;border-bottom:1px solid #e2e2de;vertical-align:top;"
      "font-variant-numeric:tabular-nums}th{font-weight:600;color:#555}"
      ".pictures{display:flex;flex-wrap:wrap;gap:14px}figure{margin:0;max-width:100%}"
      "figure img{display:block;max-width:min(100%,520px);min-width:240px;background:#000;image-rendering:auto}"
      ".wide img{max-width:100%}figcaption{color:#555;font-size:.87em;max-width:520px}"
      ".pictures figure{width:520px}svg "
      "text{font-size:12px;fill:#444}.grid{stroke:#ddd}.level{stroke:#888;stroke-dasharray:5 4}"
      ".warning{border-left:4px solid #d55e00;padding:.2em .8em;margin:.4em 0;background:#fff4ec}"
      "pre{background:#f0f0ec;padding:.8em;overflow:auto;font-size:.85em}";
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>{}</title><style>{}</style></head>\n<body>\n<h1>{}</h1>\n{}</body></"
      "html>\n",
      html_text(title), kStyle, html_text(title), body);
}

}  // namespace patchlight
