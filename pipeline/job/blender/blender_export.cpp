#include "pipeline/job/blender/blender_export.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "pipeline/job/blender/blender_program.h"
#include "pipeline/model/error.h"
#include "pipeline/system/child_process.h"
#include "pipeline/system/content_hash.h"
#include "pipeline/system/temporary_file.h"

namespace patchlight {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFolder = "blend";              // of an output
constexpr const char* kRecord = "export.json";        // what an export was made of, and its warnings
constexpr const char* kSays = "patchlight-export: ";  // begins lines of the exporter
constexpr int kLevels = 4;                            // folders above an output in which exports are looked for

/// Hash of the exporter's files, and of what else an export depends on.
std::string exporter_hash(const fs::path& exporter) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(exporter))
    if (entry.path().extension() == ".py" && entry.path().parent_path().filename() != "addon")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  KeyHasher hasher;
  const char* const ocio = std::getenv("OCIO");  // named in the job
  hasher.add(ocio ? ocio : "");
  for (const fs::path& file : files) hasher.add(file.lexically_relative(exporter).string()).add(hash_file(file));
  return hasher.hex();
}

/// Hash of a file; empty without one.
std::string hash_of(const fs::path& file) {
  std::error_code fault;
  return fs::is_regular_file(file, fault) ? hash_file(file) : "";
}

/// Whether a path of a record is a file in its folder.
bool is_name(const fs::path& file) {
  return file.has_filename() && file.filename() == file && file != ".." && file != ".";
}

/// The lines of the exporter of one kind, without what they begin with.
std::vector<std::string> lines_of(const std::string& text, const std::string& kind) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with(kSays + kind)) lines.push_back(line.substr((kSays + kind).size()));
  return lines;
}

/// The last line of a program that says something; empty if none does.
std::string last_line(const ProgramOutput& run) {
  std::string last;
  for (const std::string* text : {&run.out, &run.err}) {
    std::istringstream stream(*text);
    for (std::string line; std::getline(stream, line);)
      if (line.find_first_not_of(" \t\r") != std::string::npos && line != "Blender quit") last = line;
  }
  return last;
}

json read_json(const fs::path& file) {
  std::ifstream stream(file);
  return json::parse(stream, nullptr, false);
}

/// The export in a folder, if it is of this file as it is now, by this exporter.
std::optional<BlenderExport> fresh_export(const fs::path& folder, const fs::path& blend, const std::string& content,
                                          const std::string& exporter) {
  const json record = read_json(folder / kRecord);
  try {
    if (!record.is_object() || record.at("content") != content || record.at("exporter") != exporter) return {};
    for (const auto& [file, hash] : record.at("inputs").items())
      if (hash_of(blend.parent_path() / file) != hash) return {};
    for (const auto& [file, hash] : record.at("files").items())
      if (!is_name(file) || hash_of(folder / file) != hash) return {};
    return BlenderExport{folder / fs::path(blend.filename()).replace_extension(".yaml"), record.at("warnings"), {}, {}};
  } catch (const json::exception&) {
    return {};
  }
}

/// Throws what the run of Blender says that went wrong.
[[noreturn]] void refuse(const fs::path& blend, const ProgramOutput& run) {
  if (const auto errors = lines_of(run.err, "error: "); !errors.empty()) {
    const bool is_known = run.exit_code == int(ExitCode::bad_data) || run.exit_code == int(ExitCode::unavailable) ||
                          run.exit_code == int(ExitCode::cannot_create);
    throw Error(is_known ? ExitCode(run.exit_code) : ExitCode::internal, errors.back(), blend, "");
  }
  if (run.exit_code == int(ExitCode::interrupted))
    throw Error(ExitCode::interrupted, "Blender was interrupted", blend, "run it again");
  for (const std::string* text : {&run.err, &run.out})
    for (const char* const sign : {"not a blend file", "File format is not supported", "Cannot read file",
                                   "Failed to read blend file", "Missing DNA block"})
      if (text->find(sign) != std::string::npos)
        throw Error(ExitCode::bad_data, "Blender cannot read the file", blend,
                    "is it a whole Blender file, saved by no newer Blender?");
  const std::string last = last_line(run);
  const std::string what = run.exit_code == int(ExitCode::internal) ? "Blender crashed"
                           : run.exit_code == 0                     ? "Blender wrote no export"
                                                : fmt::format("Blender ended with exit code {}", run.exit_code);
  throw Error(ExitCode::unavailable, last.empty() ? what : fmt::format("{}; last it said: {}", what, last), blend,
              "open the file in Blender; if that works, report what `patchlight from-blend` prints");
}

/// Keeps other runs from exporting into a folder, which it creates. Does nothing on file systems without locks.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder) {
    std::error_code fault;
    fs::create_directories(folder, fault);
    folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder_ < 0)
      throw Error(ExitCode::cannot_create, "cannot make the folder of the export", folder,
                  "choose another output with --output");
    if (::flock(folder_, LOCK_EX) == 0 || errno != EINTR) return;
    ::close(folder_);
    throw Error(ExitCode::interrupted, "interrupted while another run exports", folder, "run it again");
  }
  ~FolderLock() { ::close(folder_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_;
};

/// Removes what killed exports left in a folder.
void remove_leftovers(const fs::path& folder, const fs::path& blend) {
  std::error_code fault;
  const std::string of_blend = "." + blend.stem().string() + ".";
  for (const auto& entry : fs::directory_iterator(folder, fault)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(kTemporaryPrefix) || (name.starts_with(of_blend) && entry.is_directory(fault)))
      fs::remove_all(entry.path(), fault);
  }
}

}  // namespace

std::vector<fs::path> files_of_export(const fs::path& output) {
  const fs::path folder = output / kFolder;
  const json record = read_json(folder / kRecord);
  std::vector<fs::path> files{folder / kRecord};
  try {
    if (!record.is_object()) return {};
    for (const auto& [file, hash] : record.at("files").items()) {
      if (!is_name(file) || hash_of(folder / file) != hash) return {};
      files.push_back(folder / file);
    }
  } catch (const json::exception&) {
    return {};
  }
  return files;
}

BlenderExport export_blender_file(const fs::path& blend, const fs::path& folder) {
  std::error_code fault;
  if (!fs::is_regular_file(blend, fault))
    throw Error(ExitCode::missing_input, "missing scene", blend.string(), "check the path");
  const fs::path blender = blender_program(), exporter = blender_exporter();
  const fs::path used = folder / fmt::format("{}{}.json", kTemporaryPrefix, ::getpid());
  // By more threads, normals and exact Booleans differ from one run to the next, and all stages would run again.
  const ProgramOutput run =
      capture_program(blender,
                      {"--threads", "1", "--background", "--factory-startup", "--disable-autoexec", fs::absolute(blend),
                       "--python-exit-code", "70", "--python", exporter / "export.py", "--", "--output",
                       fs::absolute(folder), "--record", fs::absolute(used)},
                      "install Blender 3.4 or newer, or set $BLENDER to its program");
  BlenderExport result{
      folder / fs::path(blend.filename()).replace_extension(".yaml"), lines_of(run.err, "warning: "), {}, {}};
  const json record = read_json(used);
  fs::remove(used, fault);
  if (run.exit_code != 0 || !fs::is_regular_file(result.job, fault)) refuse(blend, run);
  try {
    result.inputs = record.at("inputs").get<std::vector<std::string>>();
    result.files = record.at("files").get<std::vector<std::string>>();
  } catch (const json::exception& error) {
    throw Error(ExitCode::internal, fmt::format("a bad record of the exporter: {}", error.what()), used, "report it");
  }
  return result;
}

BlenderExport cached_blender_export(const fs::path& blend, const fs::path& output) {
  std::error_code fault;
  if (!fs::is_regular_file(blend, fault))
    throw Error(ExitCode::missing_input, "missing scene", blend.string(), "check the path");
  const std::string content = hash_file(blend), exporter = exporter_hash(blender_exporter());
  const fs::path own = fs::absolute(output).lexically_normal() / kFolder;
  fs::path above = own.parent_path();
  for (int level = 0; level < kLevels; ++level, above = above.parent_path())
    if (auto found = fresh_export(above / kFolder, blend, content, exporter)) return *found;
  const FolderLock lock(own);
  if (auto found = fresh_export(own, blend, content, exporter)) return *found;  // of another run, meanwhile
  remove_leftovers(own, blend);
  std::vector<fs::path> old = files_of_export(own.parent_path());
  fs::remove(own / kRecord, fault);
  const auto start = fs::file_time_type::clock::now();
  BlenderExport result = export_blender_file(blend, own);
  for (const fs::path& file : old)
    if (std::ranges::find(result.files, file.filename().string()) == result.files.end()) fs::remove(file, fault);
  const auto is_newer = [&](const std::string& file) {
    const auto changed = fs::last_write_time(blend.parent_path() / file, fault);
    return !fault && changed > start;
  };
  if (std::any_of(result.inputs.begin(), result.inputs.end(), is_newer)) return result;  // it may be of either content
  json record{{"content", content}, {"exporter", exporter}, {"warnings", result.warnings}};
  record["inputs"] = record["files"] = json::object();
  for (const std::string& file : result.inputs) record["inputs"][file] = hash_of(blend.parent_path() / file);
  for (const std::string& file : result.files) record["files"][file] = hash_of(own / file);
  write_text(own / kRecord, record.dump(1));
  return result;
}

}  // namespace patchlight
