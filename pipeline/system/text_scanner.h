#pragma once
#include <initializer_list>
#include <string_view>

namespace patchlight {

/// Reads a short text from its beginning, token by token. std::regex overflows the stack on long texts.
class TextScanner {
 public:
  /// The text must outlive the scanner.
  explicit TextScanner(std::string_view text) : rest_(text) {}

  /// Skips `token` if the text continues with it. Returns whether it did.
  bool skip(std::string_view token) {
    if (rest_.substr(0, token.size()) != token) return false;
    rest_.remove_prefix(token.size());
    return true;
  }

  /// Skips the first of `tokens` that the text continues with. Returns whether there was one.
  bool skip_any(std::initializer_list<std::string_view> tokens) {
    for (const std::string_view token : tokens)
      if (skip(token)) return true;
    return false;
  }

  /// Takes the characters that `allowed` accepts, as many as there are.
  template <class Allowed>
  std::string_view take(const Allowed& allowed) {
    std::size_t length = 0;
    while (length < rest_.size() && allowed(rest_[length])) ++length;
    const std::string_view taken = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return taken;
  }

  /// Takes the decimal digits 0 to 9 that follow, as many as there are.
  std::string_view take_digits() {
    return take([](char c) { return c >= '0' && c <= '9'; });
  }

  std::string_view rest() const { return rest_; }
  bool done() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

}  // namespace patchlight
