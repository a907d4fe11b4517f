#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "pipeline/model/shard.h"

namespace patchlight {

/// An option or an argument of a program.
struct Option {
  /// Where its value goes. bool: a flag; uint64: a size in bytes; vector: may be given several times.
  using Value = std::variant<bool*, int*, std::uint64_t*, std::optional<std::int64_t>*, std::string*,
                             std::vector<std::string>*, std::optional<Shard>*>;
  enum class Completion { none, file, folder };

  std::string name;  ///< `--name`; any other name is an argument's.
  Value value;
  std::string help;
  bool required = false;
  bool not_empty = false;
  bool not_negative = false;
  bool shows_default = false;
  std::optional<std::pair<int, int>> range = {};  ///< First and last value of an int.
  std::vector<std::string> choices = {};          ///< Empty: any.
  std::string excludes = {};                      ///< An option that stands before this one.
  Completion completion = Completion::none;
};

/// A program or a subcommand.
struct Command {
  std::string name;
  std::string purpose;
  std::vector<Option> options = {};
  std::string (*footer)() = nullptr;      ///< Ends its help.
  std::vector<Command> subcommands = {};  ///< If there are any, one must be given.
};

struct ParsedCommand {
  std::optional<int> exit_code;  ///< The program is to end at once: after help or a version, or for wrong usage.
  std::string subcommand;
};

/// Sets the values of a program's options. Also does what its --help, --version and, for a shell's completion script,
/// `--completion bash|zsh` ask for.
ParsedCommand parse_command_line(const Command& program, int argc, char** argv);

}  // namespace patchlight
