#include <gmock/gmock.h>

#include <algorithm>
#include <regex>
#include <sstream>

#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"
#include "tests/end_to_end/docs/readme.h"
#include "tests/temporary_folder.h"

namespace patchlight::test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kCode{".cpp", ".h"};

Readme readme_of(const std::string& folder) {
  return read_readme(source_tree() / folder / "README.md");
}

/// Checks one target of a link. Returns what is wrong; empty: nothing.
std::string link_fault(const Readme& readme, const std::string& target) {
  if (std::regex_search(target, std::regex("^(https?|mailto):"))) return "";
  const std::size_t hash = target.find('#');
  const std::string path = target.substr(0, hash);
  const fs::path file = path.empty() ? readme.file : readme.file.parent_path() / path;
  if (!fs::exists(file)) return "there is no file " + target;
  if (hash == std::string::npos) return "";
  if (file.extension() != ".md") return "an anchor of no Markdown file: " + target;
  return read_readme(file).anchors.contains(target.substr(hash + 1)) ? "" : "there is no heading " + target;
}

TEST(Docs, EveryRelativeLinkLeadsToAFileAndAHeading) {
  const std::regex link(R"(\]\(([^) ]+)\)|(?:src|href)="([^"]+)\")");
  std::size_t links = 0;
  for (const Readme& readme : all_readmes()) {
    std::istringstream stream(readme.text);
    int number = 0;
    for (std::string line; std::getline(stream, line);) {
      ++number;
      for (std::sregex_iterator found(line.begin(), line.end(), link), end; found != end; ++found, ++links) {
        const std::string target = (*found)[1].matched ? (*found)[1] : (*found)[2];
        EXPECT_EQ(link_fault(readme, target), "") << readme.place(number);
      }
    }
  }
  EXPECT_GT(links, 20u);
}

TEST(Docs, EveryPathOfTheTreeThatIsNamedIsThere) {
  for (const Readme& readme : all_readmes()) {
    std::istringstream stream(readme.text);
    int number = 0;
    for (std::string line; std::getline(stream, line);) {
      ++number;
      for (const std::string& span : code_spans(line)) {
        if (!is_tree_path(span) || span.find_first_of(" *<{,") != std::string::npos) continue;
        EXPECT_TRUE(fs::exists(source_tree() / span)) << readme.place(number) << ": there is no " << span;
      }
    }
  }
}

TEST(Docs, TheFirstPageIsShort) {
  EXPECT_LE(readme_of("").lines, 150u);
}

TEST(Docs, EveryYamlBlockIsAJob) {
  const std::regex include("(^|\n)include: *([^ \n]+)");
  std::size_t blocks = 0;
  for (const Readme& readme : all_readmes())
    for (const CodeBlock& block : readme.blocks_of("yaml")) {
      const TemporaryFolder folder;
      std::string text = block.text;
      if (std::smatch found; std::regex_search(text, found, include))
        folder.write(found[2], "scene: a.glb\noutput: out\n");
      for (const char* needed : {"scene: a.glb\n", "output: out\n"}) {
        const std::string key = std::string(needed).substr(0, std::string(needed).find(' '));
        if (!std::regex_search(text, std::regex("(^|\n)" + key))) text = needed + text;
      }
      EXPECT_NO_THROW({
        try {
          read_job(folder.write("job.yaml", text));
        } catch (const Error& error) {
          ADD_FAILURE() << readme.place(block.line) << ": " << error.what();
        }
      });
      ++blocks;
    }
  EXPECT_GE(blocks, 10u);
}

/// Keys and defaults by the program's help.
std::map<std::string, std::string> keys_of_help() {
  std::map<std::string, std::string> keys;
  std::istringstream stream(job_key_help());
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with("  ") || !line.ends_with(")")) continue;
    // The value is in the last parentheses, which may hold others.
    std::size_t open = line.size() - 1;
    for (int depth = 0; open > 0; --open) {
      depth += line[open] == ')' ? 1 : line[open] == '(' ? -1 : 0;
      if (depth == 0) break;
    }
    keys[line.substr(2, line.find(' ', 2) - 2)] = line.substr(open + 1, line.size() - open - 2);
  }
  return keys;
}

std::string first_span(const std::string& cell) {
  const std::vector<std::string> spans = code_spans(cell);
  return spans.empty() ? cell : spans.front();
}

TEST(Docs, EveryJobKeyIsListedWithItsDefault) {
  const std::map<std::string, std::string> keys = keys_of_help();
  ASSERT_GT(keys.size(), 40u);
  std::map<std::string, std::string> listed;
  const Readme readme = readme_of("pipeline");
  bool in_table = false;
  for (const TableRow& row : table_rows(readme)) {
    if (row.cells.size() != 3) continue;
    if (row.cells[0] == "key" || row.cells[0] == "message") in_table = row.cells[1] == "default";
    if (!in_table || !row.cells[0].starts_with("`")) continue;
    listed[first_span(row.cells[0])] = first_span(row.cells[1]);
  }
  EXPECT_THAT(listed, ::testing::ContainerEq(keys));
}

/// Settings of names below a section, as `materials.NAME.reflectance` is listed, are taken by the job reader; and those
/// that the schema's sources have are listed.
TEST(Docs, EverySettingOfANameIsListed) {
  const std::regex listed("(materials|lights|cameras|shaders)[.](NAME|GROUP)[.]([a-z_]+)");
  std::set<std::string> names;
  for (const TableRow& row : table_rows(readme_of("pipeline"))) {
    std::smatch found;
    if (!std::regex_search(row.cells[0], found, listed)) continue;
    names.insert(found[3]);
    const TemporaryFolder folder;
    const std::string job =
        "scene: a.glb\noutput: out\n" + std::string(found[1]) + ": {a: {" + std::string(found[3]) + ": [[]]}}\n";
    try {
      read_job(folder.write("job.yaml", job));
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), ::testing::Not(::testing::HasSubstr("unknown key"))) << row.line;
    }
  }
  const std::string schema = source_text({"pipeline/job/schema"}, {"_schema.cpp"});
  const std::regex entry(R"re(\{"([a-z_]+)", \[&\])re");
  for (std::sregex_iterator found(schema.begin(), schema.end(), entry), end; found != end; ++found)
    EXPECT_TRUE(names.contains((*found)[1])) << "pipeline/README.md does not list the setting " << (*found)[1];
}

TEST(Docs, EveryExitCodeIsListed) {
  std::set<std::string> listed;
  for (const TableRow& row : table_rows(readme_of("pipeline"))) listed.insert(row.cells[0]);
  const std::string text = read_text(source_tree() / "pipeline/model/error.h");
  const std::regex code(R"([a-z_]+ = (\d+),)");
  std::size_t codes = 0;
  for (std::sregex_iterator found(text.begin(), text.end(), code), end; found != end; ++found, ++codes)
    EXPECT_TRUE(listed.contains((*found)[1])) << "pipeline/README.md does not list exit code " << (*found)[1];
  EXPECT_GT(codes, 8u);
}

TEST(Docs, EveryMessageOfTheTroubleshootingTableIsInTheCode) {
  const std::string code = source_text({"pipeline", "importers", "solver", "tracer"}, kCode);
  const std::string ellipsis = "…";
  std::size_t messages = 0;
  bool in_table = false;
  for (const TableRow& row : table_rows(readme_of("pipeline"))) {
    if (row.cells[0] == "message") in_table = true;
    if (!in_table || row.cells[0].find('`') == std::string::npos) continue;
    ++messages;
    std::string rest = first_span(row.cells[0]) + ellipsis;
    for (std::size_t end; (end = rest.find(ellipsis)) != std::string::npos; rest = rest.substr(end + ellipsis.size())) {
      std::string part = rest.substr(0, end);
      part.erase(0, std::min(part.find_first_not_of(' '), part.size()));
      part.erase(part.find_last_not_of(' ') + 1);
      EXPECT_NE(code.find(part), std::string::npos)
          << "no message has `" << part << "` (pipeline/README.md, line " << row.line << ")";
    }
  }
  EXPECT_GT(messages, 20u);
}

}  // namespace
}  // namespace patchlight::test
