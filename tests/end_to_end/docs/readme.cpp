#include "tests/end_to_end/docs/readme.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>
#include <sstream>

#include "tests/temporary_folder.h"

namespace patchlight::test {

namespace fs = std::filesystem;

namespace {

/// As GitHub makes an anchor of a heading: lower case, spaces to dashes, no other signs.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == ' ')
      anchor += '-';
    else if (std::isalnum(byte) || c == '-' || c == '_' || byte >= 128)
      anchor += static_cast<char>(std::tolower(byte));
  }
  return anchor;
}

bool ends_with_any(const std::string& name, const std::vector<std::string>& endings) {
  return std::any_of(endings.begin(), endings.end(), [&](const std::string& ending) { return name.ends_with(ending); });
}

}  // namespace

std::string Readme::place(int line) const {
  return file.lexically_relative(source_tree()).string() + ", line " + std::to_string(line);
}

std::vector<CodeBlock> Readme::blocks_of(const std::string& language) const {
  std::vector<CodeBlock> result;
  for (const CodeBlock& block : blocks)
    if (block.language == language) result.push_back(block);
  return result;
}

const fs::path& source_tree() {
  static const fs::path root(PATCHLIGHT_SOURCE);
  return root;
}

Readme read_readme(const fs::path& file) {
  Readme readme;
  readme.file = file;
  std::istringstream stream(read_text(file));
  std::map<std::string, int> seen;
  CodeBlock* open = nullptr;
  for (std::string line; std::getline(stream, line);) {
    ++readme.lines;
    const bool fence = line.starts_with("```");
    if (open) {
      if (fence)
        open = nullptr;
      else
        open->text += line + "\n";
      line.clear();
    } else if (fence) {
      open = &readme.blocks.emplace_back(CodeBlock{line.substr(3), int(readme.lines) + 1, ""});
      line.clear();
    } else if (line.starts_with("#")) {
      const std::string anchor = anchor_of(line.substr(line.find_first_not_of("# ")));
      const int count = seen[anchor]++;
      readme.anchors.insert(count == 0 ? anchor : anchor + "-" + std::to_string(count));
    }
    readme.text += line + "\n";
  }
  return readme;
}

std::vector<Readme> all_readmes() {
  std::vector<Readme> readmes;
  for (fs::recursive_directory_iterator entry(source_tree()), end; entry != end; ++entry) {
    const std::string name = entry->path().filename().string();
    if (entry->is_directory() && (name == ".git" || name.starts_with("build") || name == "out"))
      entry.disable_recursion_pending();
    if (name == "README.md") readmes.push_back(read_readme(entry->path()));
  }
  return readmes;
}

bool is_tree_path(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos || slash == 0 || text.find("/out/") != std::string::npos) return false;
  const std::string top = text.substr(0, slash);
  return top != "build" && top != ".." && top != "." && fs::exists(source_tree() / top);
}

std::vector<TableRow> table_rows(const Readme& readme) {
  std::vector<TableRow> rows;
  std::istringstream stream(readme.text);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (!line.starts_with("| ")) continue;
    TableRow row{number, {}};
    std::string cell;
    for (std::size_t i = 1; i < line.size(); ++i) {
      if (line[i] == '\\' && i + 1 < line.size() && line[i + 1] == '|') {
        cell += line[++i];
      } else if (line[i] == '|') {
        const std::size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
        row.cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
        cell.clear();
      } else {
        cell += line[i];
      }
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<std::string> code_spans(const std::string& text) {
  static const std::regex span("(``) (.*?) ``|`([^`\n]+)`");
  std::vector<std::string> spans;
  for (std::sregex_iterator found(text.begin(), text.end(), span), end; found != end; ++found)
    spans.push_back((*found)[1].matched ? (*found)[2] : (*found)[3]);
  return spans;
}

std::string source_text(const std::vector<std::string>& folders, const std::vector<std::string>& endings) {
  std::string all;
  for (const std::string& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(source_tree() / folder))
      if (entry.is_regular_file() && ends_with_any(entry.path().filename().string(), endings))
        all += read_text(entry.path()) + "\n";
  std::string joined;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t next = all[i] == '"' ? all.find_first_not_of(" \n", i + 1) : std::string::npos;
    if (next != std::string::npos && next > i + 1 && all[next] == '"' && all.find('\n', i) < next)
      i = next;  // where one part ends and the next begins
    else
      joined += all[i];
  }
  return joined;
}

}  // namespace patchlight::test
