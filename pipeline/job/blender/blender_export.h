#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// What Blender made of a Blender file.
struct BlenderExport {
  std::filesystem::path job;          ///< A job; its scene and images are beside it.
  std::vector<std::string> warnings;  ///< Of what could not be kept.
  std::vector<std::string> inputs;    ///< Further files that were read, relative to the Blender file; of a new export.
  std::vector<std::string> files;     ///< Names of the files that a new export wrote into the folder; else empty.
};

/// Runs Blender, which writes a glTF scene and a job for a Blender file into a folder. Throws: Error (missing_input)
/// without a file; (unavailable) if Blender is missing, too old or crashes; (bad_data) if it cannot read the file;
/// (cannot_create) if the folder cannot be written.
BlenderExport export_blender_file(const std::filesystem::path& blend, const std::filesystem::path& folder);

/// An export of a Blender file, for a job with this output folder: one that was made before of the same content by the
/// same exporter, in the folder `blend` of the output or of a folder above it, which serves variants; else a new one in
/// that of the output. The content of libraries, images and photometric files that the Blender file names counts too.
/// Throws: errors of export_blender_file().
BlenderExport cached_blender_export(const std::filesystem::path& blend, const std::filesystem::path& output);

/// The files of an export in an output folder, and the record of them; none if they were changed.
std::vector<std::filesystem::path> files_of_export(const std::filesystem::path& output);

}  // namespace patchlight
