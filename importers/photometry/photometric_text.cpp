#include "importers/photometry/photometric_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "pipeline/model/error.h"

namespace patchlight {
namespace {

constexpr std::size_t kLongestWord = 40;  // in messages

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\0';
}

bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// A number that is the whole word; NaN if it is none or not finite.
double parsed(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_whole = fault == std::errc() && end == word.data() + word.size();
  return is_whole && std::isfinite(value) ? value : std::nan("");
}

/// A word as messages show it: without characters that a terminal or a log would take for something else.
std::string shown(std::string_view word) {
  std::string text(word.substr(0, kLongestWord));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

}  // namespace

PhotometricText::PhotometricText(std::string_view text, std::string name) : rest_(text), name_(std::move(name)) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

void PhotometricText::take(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_pair = rest_[i] == '\r' && i + 1 < rest_.size() && rest_[i + 1] == '\n';
    line_ += is_line_end(rest_[i]) && !is_pair;
  }
  rest_.remove_prefix(count);
}

void PhotometricText::refuse(const std::string& what) const {
  throw Error(ExitCode::bad_data, what, fmt::format("{}, line {}", name_, last_line_),
              "correct the photometric file, or get it again from the luminaire's manufacturer");
}

std::string_view PhotometricText::line(const std::string& what) {
  last_line_ = line_;
  if (at_end()) refuse("the file ends before " + what);
  const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
  const std::string_view taken = rest_.substr(0, end);
  std::size_t next = end;
  if (next < rest_.size()) next += rest_.substr(next).starts_with("\r\n") ? 2 : 1;
  take(next);
  return trimmed(taken);
}

double PhotometricText::number(const std::string& what) {
  std::size_t skipped = 0;
  while (skipped < rest_.size() && (is_blank(rest_[skipped]) || is_line_end(rest_[skipped]) || rest_[skipped] == ','))
    ++skipped;
  take(skipped);
  last_line_ = line_;
  if (at_end()) refuse("the file ends before " + what);
  std::size_t length = 0;
  while (length < rest_.size() && !is_blank(rest_[length]) && !is_line_end(rest_[length]) && rest_[length] != ',')
    ++length;
  const std::string_view word = rest_.substr(0, length);
  const double value = parsed(word);
  if (std::isnan(value)) refuse(fmt::format("'{}' stands where {} is expected, a finite number", shown(word), what));
  take(length);
  return value;
}

double PhotometricText::line_number(const std::string& what) {
  std::string word(line(what).substr(0, 100));
  word.resize(std::min(word.find_first_of(" \t;"), word.size()));
  std::replace(word.begin(), word.end(), ',', '.');
  const double value = parsed(word);
  if (std::isnan(value)) refuse(fmt::format("'{}' stands where {} is expected, a finite number", shown(word), what));
  return value;
}

int PhotometricText::whole(double value, const std::string& what, int low, int high) const {
  if (!(value >= low && value <= high) || value != std::floor(value))
    refuse(fmt::format("{} is {}; it must be a whole number from {} to {}", what, value, low, high));
  return static_cast<int>(value);
}

}  // namespace patchlight
