#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace patchlight::test {

/// A fenced code block of a Markdown file.
struct CodeBlock {
  std::string language;
  int line = 0;  ///< Of its first line, from 1.
  std::string text;
};

/// A README.md of the source tree.
struct Readme {
  std::filesystem::path file;
  std::string text;  ///< Without code blocks, whose lines are empty.
  std::vector<CodeBlock> blocks;
  std::set<std::string> anchors;  ///< Of its headings, as GitHub makes them.
  std::size_t lines = 0;

  /// For messages: path below the source tree, and a line.
  std::string place(int line) const;
  std::vector<CodeBlock> blocks_of(const std::string& language) const;
};

/// The root of the source tree.
const std::filesystem::path& source_tree();

Readme read_readme(const std::filesystem::path& file);

/// All README.md files of the source tree, without build folders.
std::vector<Readme> all_readmes();

/// Names in the root of the source tree: what a path in a README.md can begin with.
bool is_tree_path(const std::string& text);

/// A row of a table: the text of its cells, code marks and all.
struct TableRow {
  int line = 0;
  std::vector<std::string> cells;
};
std::vector<TableRow> table_rows(const Readme& readme);

/// Code spans of a text, without their marks.
std::vector<std::string> code_spans(const std::string& text);

/// The files below folders of the source tree whose names end so, each read and joined to one text. String literals in
/// several parts become one.
std::string source_text(const std::vector<std::string>& folders, const std::vector<std::string>& endings);

}  // namespace patchlight::test
