#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/driver/bench/bench_report.h"
#include "pipeline/image/image_text.h"

namespace patchlight {

namespace {

constexpr std::size_t kMaxRows = 12;
constexpr int kMaxTileWidth = 400, kMinTileWidth = 192;  // pixels
constexpr int kMargin = 20, kGap = 10, kLine = 26, kHeader = 64;
const Color kPaper(0.13f), kInk(0.88f), kFaint(0.6f);

float srgb(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);  // NaN stays and shows as black
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

/// -1 is deep blue, 0 is white, 1 is deep red.
Color diverging(double t) {
  constexpr std::array<std::array<float, 3>, 5> stops{
      {{0.02f, 0.19f, 0.38f}, {0.26f, 0.58f, 0.76f}, {0.97f, 0.97f, 0.97f}, {0.84f, 0.38f, 0.30f}, {0.40f, 0, 0.12f}}};
  const double at = (std::clamp(t, -1.0, 1.0) + 1) * 2;
  const std::size_t i = std::min(std::size_t(at), std::size_t(3));
  const float f = float(at - double(i));
  Color color;
  for (int k = 0; k < 3; ++k) color[k] = stops[i][k] * (1 - f) + stops[i + 1][k] * f;
  return color;
}

double luminance(const Color& c) {
  return 0.2126 * double(c.x) + 0.7152 * double(c.y) + 0.0722 * double(c.z);
}

/// Signed relative error of luminance for each pixel; a hundredth of the mean is added to the divisor, against black.
std::vector<double> relative_error(const Image& frame, const Image& reference) {
  double mean = 0;
  for (const Color& c : reference.pixels) mean += luminance(c) / double(reference.pixels.size());
  std::vector<double> error(frame.pixels.size(), 0.0);
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double r = luminance(reference.pixels[i]), d = luminance(frame.pixels[i]) - r;
    if (d != 0 && std::isfinite(d)) error[i] = d / (r + 0.01 * mean);
  }
  return error;
}

/// Frame and reference of one row, scaled to the tile size, and their caption.
struct Row {
  Image frame;
  Image reference;
  std::vector<double> error;
  std::string label;
};

/// The smallest factor that divides both sides and makes the picture fit the tile.
int reduction(const Image& image) {
  for (int k = 1; k <= image.width; ++k)
    if (image.width % k == 0 && image.height % k == 0 && image.width / k <= kMaxTileWidth) return k;
  return 1;
}

Row make_row(const Measurement& m, const Reference& reference) {
  Row row;
  row.frame = read_exr(m.frame);
  row.reference = reference.like(row.frame);
  const int height = std::min(row.frame.height, row.reference.height);
  row.frame = box_reduced(row.frame, height);
  row.reference = box_reduced(row.reference, height);
  const int reduced = height / reduction(row.frame);
  row.frame = box_reduced(row.frame, reduced);
  row.reference = box_reduced(row.reference, reduced);
  row.error = relative_error(row.frame, row.reference);
  row.label = fmt::format("{}:  {:.3g} CPU s, block error {:.2g}%, bias {:+.2g}%", m.variant.label, m.cpu_seconds(),
                          100 * m.error.block, 100 * m.error.bias);
  return row;
}

/// The colour range: contains 95% of all pixels, rounded up to 1, 2 or 5 times a power of ten.
double error_range(const std::vector<Row>& rows) {
  std::vector<double> all;
  for (const Row& row : rows)
    for (const double e : row.error) all.push_back(std::abs(e));
  const auto at = all.begin() + std::ptrdiff_t(all.size() * 95 / 100);
  std::nth_element(all.begin(), at, all.end());
  const double wanted = std::max(*at, 1e-3), decade = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {1.0, 2.0, 5.0})
    if (wanted <= step * decade * 1.0001) return step * decade;
  return 10 * decade;
}

/// Puts display-ready pixels at (left, top), each as a square of `scale` pixels.
void place(Image& sheet, const Image& tile, int left, int top, int scale) {
  for (int y = 0; y < tile.height * scale; ++y)
    for (int x = 0; x < tile.width * scale; ++x)
      sheet.pixels[std::size_t(top + y) * sheet.width + std::size_t(left + x)] =
          tile.pixels[std::size_t(y / scale) * tile.width + std::size_t(x / scale)];
}

Image displayed(Image image, double exposure) {
  const float gain = float(std::exp2(exposure));
  for (Color& c : image.pixels) c = Color(srgb(c.x * gain), srgb(c.y * gain), srgb(c.z * gain));
  return image;
}

Image error_map(const Row& row, double range) {
  Image map{row.frame.width, row.frame.height, {}, {}};
  for (const double e : row.error) map.pixels.push_back(diverging(e / range));
  return map;
}

void draw_scale(Image& sheet, int left, int width, double range) {
  const int top = kMargin + kLine - 4, height = 10;
  for (int x = 0; x < width; ++x)
    for (int y = 0; y < height; ++y)
      sheet.pixels[std::size_t(top + y) * sheet.width + std::size_t(left + x)] = diverging(2.0 * (x + 0.5) / width - 1);
  const std::string low = fmt::format("-{:.3g}% dark", 100 * range), high = fmt::format("bright +{:.3g}%", 100 * range);
  const int base = top + height + 15;
  draw_text(sheet, left, base, low, 13, kFaint);
  draw_text(sheet, left + (width - text_width("0", 13)) / 2, base, "0", 13, kFaint);
  draw_text(sheet, left + width - text_width(high, 13), base, high, 13, kFaint);
}

/// All finished measurements; if there are more than kMaxRows, those on the Pareto front.
std::vector<const Measurement*> chosen(const std::vector<Measurement>& measurements) {
  const std::vector<bool> pareto = on_pareto_front(measurements);
  std::vector<const Measurement*> all, front;
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    if (measurements[i].exit_code == 0) all.push_back(&measurements[i]);
    if (pareto[i]) front.push_back(&measurements[i]);
  }
  if (all.size() > kMaxRows) all = front;
  all.resize(std::min(all.size(), kMaxRows));
  return all;
}

}  // namespace

void draw_comparison(const Job& job, const Reference& reference, const std::vector<Measurement>& measurements) {
  std::vector<Row> rows;
  for (const Measurement* m : chosen(measurements)) rows.push_back(make_row(*m, reference));
  if (rows.empty()) return;
  int widest = 0, height = kHeader + kMargin;
  const auto scale_of = [](const Row& row) { return std::max(1, kMinTileWidth / row.frame.width); };
  for (const Row& row : rows) {
    widest = std::max(widest, row.frame.width * scale_of(row));
    height += kLine + row.frame.height * scale_of(row) + kGap;
  }
  int width = 2 * kMargin + 3 * widest + 2 * kGap;
  for (const Row& row : rows) width = std::max(width, 2 * kMargin + text_width(row.label, 15));
  Image sheet{width, height, std::vector<Color>(std::size_t(width) * height, kPaper), {}};
  const auto column = [&](int k) { return kMargin + k * (widest + kGap); };
  const double range = error_range(rows);
  draw_text(sheet, column(0), kMargin + 12, "variant", 15, kInk);
  draw_text(sheet, column(1), kMargin + 12, "reference", 15, kInk);
  draw_text(sheet, column(2), kMargin + 12, "relative error", 15, kInk);
  draw_scale(sheet, column(2), widest, range);
  int top = kHeader;
  for (const Row& row : rows) {
    const int scale = scale_of(row);
    draw_text(sheet, column(0), top + kLine - 8, row.label, 15, kInk);
    top += kLine;
    place(sheet, displayed(row.frame, job.trace.picture.exposure), column(0), top, scale);
    place(sheet, displayed(row.reference, job.trace.picture.exposure), column(1), top, scale);
    place(sheet, error_map(row, range), column(2), top, scale);
    top += row.frame.height * scale + kGap;
  }
  write_png(bench_folder(job) / "comparison.png", sheet);
}

}  // namespace patchlight
