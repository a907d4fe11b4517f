#include <algorithm>
#include <regex>
#include <sstream>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/formats/solution/transport_file.h"
#include "pipeline/hdf5/h5_store.h"
#include "tests/end_to_end/docs/readme.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

const std::string kGolden = std::string(PATCHLIGHT_SOURCE) + "/tests/end_to_end/golden/";

Readme formats_readme() {
  return read_readme(source_tree() / "pipeline/formats/README.md");
}

/// Datasets that the page lists, with their shapes.
std::map<std::string, std::string> listed_datasets() {
  std::map<std::string, std::string> listed;
  for (const TableRow& row : table_rows(formats_readme()))
    for (const std::string& name : code_spans(row.cells[0]))
      if (name.starts_with("/")) listed[name] = row.cells[1];
  return listed;
}

/// A dataset's name as the page has it: GROUP and EMITTER stand for names of their kind.
std::string listed_name(const std::string& name) {
  static const std::vector<std::pair<std::regex, std::string>> kinds{
      {std::regex("^/groups/.*/([a-z_]+)$"), "/groups/GROUP/$1"},
      {std::regex("^/display/irradiance/.*$"), "/display/irradiance/GROUP"},
      {std::regex("^/(emitters/factor|emitters/mirrored|display/factor)/.*$"), "/$1/EMITTER"}};
  for (const auto& [pattern, listed] : kinds)
    if (std::regex_match(name, pattern)) return std::regex_replace(name, pattern, listed);
  return name;
}

/// Whether a shape as `10 x 3` is one as `[n, 3]`: as many dimensions, and the numbers that are given.
bool shape_fits(const std::string& shape, const std::string& listed) {
  const auto parts = [](std::string text, char separator) {
    text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == '[' || c == ']' || c == ' '; }),
               text.end());
    std::vector<std::string> result;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, separator);) result.push_back(part);
    return result;
  };
  const std::vector<std::string> is = parts(shape, 'x'), wanted = parts(listed, ',');
  if (is.size() != wanted.size()) return false;
  for (std::size_t i = 0; i < is.size(); ++i)
    if (wanted[i].find_first_not_of("0123456789") == std::string::npos && wanted[i] != is[i]) return false;
  return true;
}

void expect_listed(const fs::path& file, const char* format, int version) {
  const std::map<std::string, std::string> listed = listed_datasets();
  const H5Reader reader(file, format, version);
  for (const std::string& name : reader.datasets()) {
    const auto row = listed.find(listed_name(name));
    if (row == listed.end()) {
      ADD_FAILURE() << "pipeline/formats/README.md does not list " << name;
      continue;
    }
    const std::string shape = reader.values(name).shape;
    EXPECT_TRUE(shape_fits(shape, row->second)) << name << " is " << shape << ", listed as " << row->second;
  }
}

class DocsFormats : public ProgramTest {};

TEST_F(DocsFormats, DatasetsOfEveryFileAreListedWithTheirShapes) {
  for (const std::string scene : {"cornell_box", "mirror_room"}) {
    expect_listed(kGolden + scene + "/patches.h5", kPatchFormat, kPatchVersion);
    expect_listed(kGolden + scene + "/energy.h5", kEnergyFormat, kEnergyVersion);
  }
  fs::create_directories(folder_ / "out");
  fs::copy_file(kGolden + "mirror_room/patches.h5", folder_ / "out/patches.h5");
  const Outcome solved = run_program(folder_, "patchlight-solve",
                                     {kGolden + "mirror_room/job.yaml", "--output", (folder_ / "out").string()});
  ASSERT_EQ(solved.code, 0) << solved.err;
  expect_listed(folder_ / "out/transport.h5", kTransportFormat, kTransportVersion);
}

TEST_F(DocsFormats, EveryNameThatTheWritersHaveIsListed) {
  std::string names;
  for (const auto& [name, shape] : listed_datasets()) names += name + "\n";
  const std::string code = source_text({"pipeline/formats"}, {".cpp"});
  const std::regex literal(R"re("(/[a-z0-9_/]+)"|\+ "([a-z_]+)")re");
  std::size_t literals = 0;
  for (std::sregex_iterator found(code.begin(), code.end(), literal), end; found != end; ++found, ++literals) {
    const std::string name = (*found)[1].matched ? (*found)[1] : (*found)[2];
    EXPECT_NE(names.find(name), std::string::npos) << "pipeline/formats/README.md does not list " << name;
  }
  EXPECT_GT(literals, 60u);
}

TEST_F(DocsFormats, EveryAttributeIsListed) {
  std::set<std::string> listed;
  for (const TableRow& row : table_rows(formats_readme()))
    for (const std::string& name : code_spans(row.cells[0])) listed.insert(name);
  const std::string code = source_text({"pipeline/formats", "pipeline/hdf5"}, {".cpp"});
  const std::regex attribute(R"re(writer[.]attribute\("([a-z_]+)")re");
  std::size_t attributes = 0;
  for (std::sregex_iterator found(code.begin(), code.end(), attribute), end; found != end; ++found, ++attributes)
    EXPECT_TRUE(listed.contains((*found)[1])) << "pipeline/formats/README.md does not list " << (*found)[1];
  EXPECT_GT(attributes, 20u);
}

TEST_F(DocsFormats, ThePythonExampleRuns) {
  const std::vector<CodeBlock> examples = formats_readme().blocks_of("python");
  ASSERT_EQ(examples.size(), 1u);
  folder_.write("example.py", examples[0].text);
  for (const char* file : {"patches.h5", "energy.h5"}) fs::copy_file(kGolden + "mirror_room/" + file, folder_ / file);
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    if (std::system((python + " -c 'import h5py' >/dev/null 2>&1").c_str()) != 0) continue;
    const std::string command = "cd " + quoted(folder_.path().string()) + " && " + python + " example.py >out.txt 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << read_text(folder_ / "out.txt");
    EXPECT_THAT(read_text(folder_ / "out.txt"), HasSubstr("lights.window"));
    return;
  }
  GTEST_SKIP() << "no python3 with h5py: install Debian's python3-h5py";
}

}  // namespace
}  // namespace patchlight::test
