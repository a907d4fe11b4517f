#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path kSource = PATCHLIGHT_SOURCE;

/// Paths of C++ files below a top-level folder, relative to the source.
std::vector<fs::path> code_files(const std::string& top) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(kSource / top))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
      files.push_back(fs::relative(entry.path(), kSource));
  return files;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream stream(kSource / file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Paths that a file includes in quotes; they are relative to the source.
std::vector<fs::path> includes_of(const fs::path& file) {
  const std::string directive = "#include \"";
  std::vector<fs::path> paths;
  for (const std::string& line : lines_of(file))
    if (line.starts_with(directive))
      paths.emplace_back(line.substr(directive.size(), line.size() - directive.size() - 1));
  return paths;
}

using FolderGraph =
    std::map<std::string, std::map<std::string, std::string>>;  ///< From, to, and one include that ties them.

FolderGraph folder_graph() {
  FolderGraph graph;
  for (const char* top : {"pipeline", "importers", "solver", "tracer"})
    for (const fs::path& file : code_files(top))
      for (const fs::path& included : includes_of(file))
        if (included.parent_path() != file.parent_path())
          graph[file.parent_path()][included.parent_path()] = file.string() + " includes " + included.string();
  return graph;
}

/// Depth-first search; returns the includes along the first circle found from `folder`.
std::string find_circle(const FolderGraph& graph, const std::string& folder, std::vector<std::string>& path,
                        std::set<std::string>& done) {
  if (done.contains(folder)) return "";
  path.push_back(folder);
  const auto edges = graph.find(folder);
  if (edges != graph.end())
    for (const auto& [next, include] : edges->second) {
      const auto start = std::find(path.begin(), path.end(), next);
      if (start != path.end()) {
        std::string circle;
        for (auto at = start; at != path.end(); ++at)
          circle += graph.at(*at).at(at + 1 == path.end() ? next : *(at + 1)) + "\n";
        return circle;
      }
      const std::string circle = find_circle(graph, next, path, done);
      if (!circle.empty()) return circle;
    }
  path.pop_back();
  done.insert(folder);
  return "";
}

TEST(Layout, FoldersDoNotIncludeEachOtherInACircle) {
  const FolderGraph graph = folder_graph();
  ASSERT_GT(graph.size(), 30u);
  std::set<std::string> done;
  for (const auto& [folder, edges] : graph) {
    std::vector<std::string> path;
    EXPECT_EQ(find_circle(graph, folder, path, done), "");
  }
}

TEST(Layout, StagesIncludeThePipelineAndThemselvesOnly) {
  for (const auto& [folder, edges] : folder_graph()) {
    const std::string top = *fs::path(folder).begin();
    for (const auto& [next, include] : edges) {
      const std::string other = *fs::path(next).begin();
      EXPECT_TRUE(other == top || (top != "pipeline" && other == "pipeline")) << include;
      EXPECT_FALSE(top != "pipeline" && next.starts_with("pipeline/driver")) << include;
    }
  }
}

TEST(Layout, AFolderHoldsAtMostFifteenUnits) {
  std::map<std::string, std::set<std::string>> units;  // a source and its header are one
  for (const char* top : {"pipeline", "importers", "solver", "tracer", "tests"})
    for (const fs::path& file : code_files(top)) units[file.parent_path()].insert(file.stem());
  for (const auto& [folder, names] : units) EXPECT_LE(names.size(), 15u) << folder;
}

TEST(Layout, AFileHasAtMostThreeHundredLines) {
  for (const char* top : {"pipeline", "importers", "solver", "tracer", "tests"})
    for (const fs::path& file : code_files(top)) EXPECT_LE(lines_of(file).size(), 300u) << file;
}

}  // namespace
