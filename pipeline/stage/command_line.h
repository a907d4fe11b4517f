#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "pipeline/job/shard.h"

namespace patchlight {

/// An option or an argument of a program.
struct Option {
  /// Destination of the value. bool: a flag; uint64: a size in bytes; vector: repeatable.
  using Value = std::variant<bool*, int*, std::uint64_t*, std::optional<std::int64_t>*, std::string*,
                             std::vector<std::string>*, std::optional<Shard>*>;
  enum class Completion { none, file, folder };

  std::string name;  ///< `--name` of an option, or the name of a positional argument.
  Value value;
  std::string help;
  bool required = false;
  bool not_empty = false;
  bool not_negative = false;
  bool shows_default = false;
  std::optional<std::pair<int, int>> range = {};  ///< First and last value of an int.
  std::vector<std::string> choices = {};          ///< Empty: any.
  std::string excludes = {};                      ///< Name of an earlier option that cannot be combined with this one.
  Completion completion = Completion::none;
};

/// A program or a subcommand.
struct Command {
  std::string name;
  std::string purpose;
  std::vector<Option> options = {};
  std::string (*footer)() = nullptr;      ///< Text at the end of its help.
  std::vector<Command> subcommands = {};  ///< If not empty, one is required.
};

struct ParsedCommand {
  std::optional<int> exit_code;  ///< Present: exit at once, after help, version or wrong usage.
  std::string subcommand;
};

/// Parses a command line into the values of the options. Also handles --help, --version and --completion bash|zsh.
ParsedCommand parse_command_line(const Command& program, int argc, char** argv);

}  // namespace patchlight
