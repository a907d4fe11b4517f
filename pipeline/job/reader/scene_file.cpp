#include "pipeline/job/reader/scene_file.h"

#include <cctype>
#include <string>

namespace patchlight {

namespace {

/// The extension in lower case.
std::string extension(const std::filesystem::path& file) {
  std::string text = file.extension().string();
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

bool is_scene_file(const std::filesystem::path& file) {
  return extension(file) == ".glb" || extension(file) == ".gltf" || is_blender_file(file);
}

bool is_blender_file(const std::filesystem::path& file) {
  return extension(file) == ".blend";
}

}  // namespace patchlight
