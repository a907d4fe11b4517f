#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "pipeline/job/reader/job_reader.h"
#include "pipeline/model/error.h"
#include "tests/end_to_end/docs/readme.h"
#include "tests/end_to_end/docs/shell_words.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

using Words = std::vector<std::string>;

/// Programs of others that commands may use.
const std::set<std::string> kForeign{"grep",  "git",    "blender", "gnuplot", "python3",
                                     "cpack", "export", "ninja",   "cd",      "ls"};

bool is_job_file(const std::string& word) {
  return word.ends_with(".yaml");
}

/// Commands in the sh blocks of every README.md, checked against the programs of this build.
class DocsCommands : public ProgramTest {
 protected:
  /// What `PROGRAM [SUBCOMMAND] --help` prints; asked once.
  const std::string& help(const std::string& program, const std::string& subcommand) {
    std::string& text = help_[program + " " + subcommand];
    if (!text.empty()) return text;
    Words arguments{"--help"};
    if (!subcommand.empty()) arguments.insert(arguments.begin(), subcommand);
    const Outcome outcome = run_program(folder_, program, arguments);
    text = outcome.code == 0 ? outcome.out : "fails";
    return text;
  }

  /// Each check returns what is wrong with a command; empty: nothing.
  std::string fault(Words words) {
    while (!words.empty() && std::regex_search(words[0], std::regex("^[A-Z_]+="))) words.erase(words.begin());
    if (words.empty()) return "";
    for (const std::string& word : words)
      if (is_tree_path(word) && word.find('*') == std::string::npos && !fs::exists(source_tree() / word))
        return "there is no " + word;
    const std::string program = fs::path(words[0]).filename().string();
    if (program.starts_with("patchlight")) return patchlight_fault(program, words);
    if (program == "cmake" || program == "ctest") return preset_fault(program, words);
    if (words[0].starts_with("build/bin/")) return target_fault(program, words);
    if (is_tree_path(words[0])) return fs::exists(source_tree() / words[0]) ? "" : "there is no " + words[0];
    return kForeign.contains(program) ? "" : "unknown program " + program;
  }

  std::string patchlight_fault(const std::string& program, const Words& words) {
    std::string subcommand;
    if (program == "patchlight" && words.size() > 1 && !words[1].starts_with("-")) {
      subcommand = words[1];
      const std::string all = help(program, "");
      if (!std::regex_search(all.substr(all.find("ubcommands")), std::regex("\n  " + subcommand + " ")))
        return "patchlight has no command " + subcommand;
    }
    const std::string& text = help(program, subcommand);
    if (text == "fails") return "there is no program " + program;
    Words sets;
    std::string job;
    for (std::size_t i = 1; i < words.size(); ++i) {
      if (is_job_file(words[i])) job = words[i];
      if (!words[i].starts_with("--")) continue;
      const std::string option = words[i].substr(0, words[i].find('='));
      if (!std::regex_search(text, std::regex("[ ,]" + option + "[ ,\n]"))) return program + " has no " + option;
      const std::string value = words[i] != option     ? words[i].substr(option.size() + 1)
                                : i + 1 < words.size() ? words[i + 1]
                                                       : "";
      std::smatch choices;
      if (std::regex_search(text, choices, std::regex(option + R"( TEXT:\{([^}]*)\})")) &&
          ("," + std::string(choices[1]) + ",").find("," + value + ",") == std::string::npos)
        return option + " " + value + " is none of " + std::string(choices[1]);
      if (option == "--set") sets.push_back(value);
    }
    return job_fault(job, sets);
  }

  /// Of overrides, by the job reader.
  std::string job_fault(const std::string& job, const Words& sets) {
    if (sets.empty()) return "";
    const fs::path file =
        is_tree_path(job) ? source_tree() / job : folder_.write("job.yaml", "scene: a.glb\noutput: out\n");
    try {
      read_job(file, sets);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  static std::string preset_fault(const std::string& program, const Words& words) {
    static const auto presets = nlohmann::json::parse(read_text(source_tree() / "CMakePresets.json"));
    const auto has = [&](const std::string& word) {
      return std::find(words.begin(), words.end(), word) != words.end();
    };
    const std::string kind = program == "ctest"  ? "testPresets"
                             : has("--workflow") ? "workflowPresets"
                             : has("--build")    ? "buildPresets"
                                                 : "configurePresets";
    const auto at = std::find(words.begin(), words.end(), "--preset");
    if (at == words.end() || at + 1 == words.end()) return "";
    for (const auto& preset : presets[kind])
      if (preset["name"] == at[1]) return "";
    return "there is no " + at[1] + " among " + kind;
  }

  /// Tests and benchmarks by their targets, with the names that their filters hold.
  static std::string target_fault(const std::string& program, const Words& words) {
    static const std::string targets = source_text({"tests"}, {"CMakeLists.txt"});
    static const std::string code = source_text({"tests"}, {".cpp", ".h"});
    const bool bench = targets.find("add_executable(" + program + " ") != std::string::npos;
    const std::string stage = program.substr(0, program.rfind("_test"));
    if (!bench && targets.find("patchlight_test(" + stage) == std::string::npos) return "there is no target " + program;
    for (const std::string& word : words) {
      if (!word.starts_with("--")) continue;
      if (!word.starts_with("--gtest_") && !word.starts_with("--benchmark_")) return program + " has no " + word;
      if (word.find("_filter=") == std::string::npos) continue;
      std::istringstream stream(word.substr(word.find('=') + 1));
      for (std::string name; std::getline(stream, name, '|');)
        if (name = name.substr(0, name.find_first_of(".*")); code.find(name) == std::string::npos)
          return "no test or benchmark is named " + name;
    }
    return "";
  }

  /// Runs a command that only looks. Returns whether it is one.
  bool run_if_cheap(const Words& words, const std::string& place) {
    if (fs::path(words[0]).filename() != "patchlight" || words.size() < 3) return false;
    if (words[1] != "info" && words[1] != "status" && words[1] != "init") return false;
    Words arguments(words.begin() + 1, words.end());
    for (std::string& word : arguments) {
      if (!is_tree_path(word)) continue;
      word = (source_tree() / word).string();
      if (words[1] == "status") arguments.insert(arguments.end(), {"--output", (folder_ / "out").string()});
      const Outcome outcome = run_program(folder_, "patchlight", arguments);
      EXPECT_LE(outcome.code, words[1] == "status" ? 1 : 0) << place << ": " << outcome.err;
      return true;
    }
    return false;
  }

 private:
  std::map<std::string, std::string> help_;
};

TEST_F(DocsCommands, EveryShellBlockParsesAndNamesWhatExists) {
  std::size_t commands = 0, run = 0;
  for (const Readme& readme : all_readmes())
    for (const CodeBlock& block : readme.blocks_of("sh")) {
      const std::string script = folder_.write("block.sh", block.text).string();
      EXPECT_EQ(std::system(("bash -n " + quoted(script)).c_str()), 0) << readme.place(block.line);
      for (const Words& words : shell_commands(block.text)) {
        EXPECT_EQ(fault(words), "") << readme.place(block.line);
        run += run_if_cheap(words, readme.place(block.line));
        ++commands;
      }
    }
  EXPECT_GT(commands, 20u);
  EXPECT_GE(run, 2u);
}

TEST_F(DocsCommands, EveryCommandInASentenceNamesWhatExists) {
  const std::regex command("^(build/bin/[^ ]+|patchlight|patchlight-(import|solve|trace|preview)|cmake|ctest) .*");
  std::size_t commands = 0;
  for (const Readme& readme : all_readmes()) {
    std::istringstream stream(std::regex_replace(readme.text, std::regex(R"(\\[|])"), "|"));
    int line = 0;
    for (std::string text; std::getline(stream, text);) {
      ++line;
      for (const std::string& span : code_spans(text)) {
        if (!std::regex_match(span, command)) continue;
        ++commands;
        for (const Words& words : shell_commands(span)) EXPECT_EQ(fault(words), "") << readme.place(line);
      }
    }
  }
  EXPECT_GT(commands, 20u);
}

TEST_F(DocsCommands, EveryCommandAndOptionOfTheProgramIsListed) {
  const std::string page = read_text(source_tree() / "pipeline/README.md");
  const std::string all = help("patchlight", "");
  std::istringstream stream(all.substr(all.find("ubcommands")));
  std::size_t commands = 0;
  const std::regex entry("^  ([a-z]+[a-z-]*) +[A-Z].*");
  for (std::string line; std::getline(stream, line);) {
    std::smatch found;
    if (!std::regex_match(line, found, entry)) continue;
    ++commands;
    EXPECT_NE(page.find("`patchlight " + std::string(found[1]) + " "), std::string::npos)
        << "pipeline/README.md does not list the command " << found[1];
    const std::string text = help("patchlight", found[1]);
    const std::regex option("\n +(?:-h,)?(--[a-z-]+)");
    for (std::sregex_iterator name(text.begin(), text.end(), option), end; name != end; ++name)
      EXPECT_NE(page.find(std::string((*name)[1])), std::string::npos)
          << "pipeline/README.md does not list " << (*name)[1] << " of " << found[1];
  }
  EXPECT_GT(commands, 7u);
}

TEST_F(DocsCommands, FaultsAreFound) {
  for (const Words& words :
       std::vector<Words>{{"patchlight", "fly", "a.yaml"},
                          {"patchlight", "run", "a.yaml", "--fast"},
                          {"patchlight", "run", "a.yaml", "--set", "solve.ray=3"},
                          {"patchlight", "preview", "a.yaml", "--kind", "nothing"},
                          {"patchlight", "run", "configs/none.yaml"},
                          {"cmake", "--workflow", "--preset", "none"},
                          {"build/bin/none_test"},
                          {"build/bin/slow_test", std::string("--gtest_filter=No") + "SuchSuite.*"},
                          {"frobnicate"}})
    EXPECT_NE(fault(words), "") << words[0];
  EXPECT_EQ(fault({"build/bin/patchlight", "run", "a.yaml", "--set", "solve.rays=3"}), "");
}

}  // namespace
}  // namespace patchlight::test
