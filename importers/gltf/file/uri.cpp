#include "importers/gltf/file/uri.h"

#include <cctype>

#include "pipeline/model/error.h"

namespace patchlight {
namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& where, const std::string& mend) {
  throw Error(ExitCode::bad_data, what, where, mend);
}

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() && hex_value(uri[i + 1]) >= 0 && hex_value(uri[i + 2]) >= 0;
    if (escape) {
      text += static_cast<char>(hex_value(uri[i + 1]) * 16 + hex_value(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

bool has_scheme(std::string_view uri) {
  if (uri.empty() || !std::isalpha(static_cast<unsigned char>(uri[0]))) return false;
  for (const char c : uri) {
    if (c == ':') return true;
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '+' && c != '-' && c != '.') return false;
  }
  return false;
}

}  // namespace

bool is_data_uri(std::string_view uri) {
  return uri.starts_with("data:");
}

Bytes decode_data_uri(std::string_view uri, const std::string& where) {
  const std::string mend = "export the scene again";
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) refuse("the data URI has no data", where, mend);
  std::string_view text = uri.substr(comma + 1);
  if (!uri.substr(0, comma).ends_with(";base64")) {
    const std::string plain = percent_decoded(text);
    return {plain.begin(), plain.end()};
  }
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  if (text.size() % 4 == 1) refuse("the data URI ends in the middle of a byte", where, mend);

  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  unsigned int bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const int value = base64_value(c);
    if (value < 0) refuse("the data URI contains a character that is not base64", where, mend);
    bits = (bits << 6 | static_cast<unsigned int>(value)) & 0xffffffu;
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes.push_back(static_cast<unsigned char>(bits >> bit_count & 0xffu));
    }
  }
  return bytes;
}

std::filesystem::path confined_path(std::string_view uri, const std::string& where) {
  const std::string mend = "keep all files of the scene in its folder and use paths relative to it";
  if (has_scheme(uri))
    refuse("URI '" + std::string(uri.substr(0, 64)) + "' has a scheme; only relative paths are allowed", where, mend);
  const std::string text = percent_decoded(uri);
  if (text.find('\0') != std::string::npos) refuse("the URI contains a zero byte", where, mend);
  if (text.starts_with('/')) refuse("URI '" + text + "' is an absolute path", where, mend);

  const std::filesystem::path path = std::filesystem::path(text).lexically_normal();
  if (path.empty() || path == "." || !path.has_filename()) refuse("URI '" + text + "' names no file", where, mend);
  if (*path.begin() == "..") refuse("URI '" + text + "' leaves the scene's folder", where, mend);
  return path;
}

}  // namespace patchlight
