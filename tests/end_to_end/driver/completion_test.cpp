#include <sstream>

#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

using Completion = ProgramTest;

/// Words of a help text that are first in their line, below a heading or anywhere.
std::vector<std::string> first_words(const std::string& help, const std::string& heading, const std::string& prefix) {
  std::vector<std::string> words;
  std::istringstream lines(help);
  bool inside = heading.empty();
  for (std::string line; std::getline(lines, line);) {
    if (line == heading) inside = true;
    std::istringstream text(line);
    std::string word;
    if (inside && line.rfind("  ", 0) == 0 && text >> word && word.rfind(prefix, 0) == 0) words.push_back(word);
  }
  return words;
}

TEST_F(Completion, NamesEverySubcommandAndOption) {
  const auto scripts = [&](const std::string& program) {
    return std::vector{run_program(folder_, program, {"--completion", "bash"}).out,
                       run_program(folder_, program, {"--completion", "zsh"}).out};
  };
  const auto check = [](const std::vector<std::string>& found, const std::vector<std::string>& words) {
    EXPECT_FALSE(words.empty());
    for (const std::string& script : found)
      for (const std::string& word : words) EXPECT_THAT(script, HasSubstr(word));
  };
  const auto driver = scripts("patchlight");
  const auto subcommands = first_words(run_program(folder_, "patchlight", {"--help"}).out, "Subcommands:", "");
  EXPECT_GE(subcommands.size(), 9u);
  check(driver, subcommands);
  for (const std::string& subcommand : subcommands)
    check(driver, first_words(run_program(folder_, "patchlight", {subcommand, "--help"}).out, "", "--"));
  for (const std::string program : {"patchlight-import", "patchlight-solve", "patchlight-trace", "patchlight-preview"})
    check(scripts(program), first_words(run_program(folder_, program, {"--help"}).out, "", "--"));
}

TEST_F(Completion, CompletesInBash) {
  folder_.write("script", run_program(folder_, "patchlight", {"--completion", "bash"}).out);
  const auto complete = [&](const std::string& line) {
    return run_program(folder_, "/bin/bash",
                       {"-c", "source ./script; COMP_WORDS=(" + line +
                                  "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _patchlight; echo ${COMPREPLY[@]}"})
        .out;
  };
  EXPECT_EQ(complete("patchlight re"), "relight report\n");
  EXPECT_EQ(complete("patchlight run --f"), "--force\n");
  EXPECT_EQ(complete("patchlight preview --kind r"), "radiosity\n");
  EXPECT_EQ(complete("patchlight run --output o"), "\n");
  std::filesystem::create_directory(folder_ / "out");
  EXPECT_EQ(complete("patchlight run --output o"), "out\n");
}

TEST_F(Completion, OtherShellsAreWrongUsage) {
  EXPECT_EQ(run_program(folder_, "patchlight", {"--completion", "fish"}).code, 64);
}

}  // namespace
}  // namespace patchlight::test
