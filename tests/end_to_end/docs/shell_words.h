#pragma once
#include <string>
#include <vector>

namespace patchlight::test {

/// The simple commands of a shell text, each as its words without quotes: split at newlines, `|`, `&&`, `||`, `;` and
/// `&`. Comments and redirections are left out, lines that end in a backslash are joined.
inline std::vector<std::vector<std::string>> shell_commands(const std::string& text) {
  std::vector<std::vector<std::string>> commands(1);
  std::string word;
  bool in_word = false;
  char quote = 0;
  const auto end_word = [&] {
    if (in_word) commands.back().push_back(word);
    word.clear();
    in_word = false;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote) {
      if (c == quote)
        quote = 0;
      else
        word += c;
    } else if (c == '\'' || c == '"') {
      quote = c;
      in_word = true;
    } else if (c == '\\' && i + 1 < text.size()) {
      if (text[++i] != '\n') {
        word += text[i];
        in_word = true;
      }
    } else if (c == '#' && !in_word) {
      while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
    } else if (c == '\n' || c == '|' || c == ';' || c == '&') {
      end_word();
      if (!commands.back().empty()) commands.emplace_back();
    } else if (c == ' ') {
      end_word();
    } else {
      word += c;
      in_word = true;
    }
  }
  end_word();
  if (commands.back().empty()) commands.pop_back();
  for (auto& command : commands) {
    std::vector<std::string> kept;
    for (std::size_t i = 0; i < command.size(); ++i) {
      if (command[i] == ">" || command[i] == "<")
        ++i;  // and its file
      else if (!command[i].starts_with('>') && !command[i].starts_with('<'))
        kept.push_back(command[i]);
    }
    command = kept;
  }
  return commands;
}

}  // namespace patchlight::test
