#include "pipeline/stage/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <sstream>

#include "pipeline/model/error.h"
#include "pipeline/stage/completion.h"
#include "pipeline/stage/version.h"
#include "pipeline/system/standard_streams.h"
#include "pipeline/system/text_scanner.h"

namespace patchlight {

namespace {

/// 1 to 9999; otherwise 0.
int take_shard_number(TextScanner& text) {
  const std::string digits(text.take_digits());
  return digits.empty() || digits.size() > 4 ? 0 : std::stoi(digits);
}

/// Reads `k/K`. Returns whether 1 <= k <= K <= kMaxShards.
bool read_shard(const std::string& value, std::optional<Shard>& shard) {
  TextScanner text(value);
  Shard read;
  read.index = take_shard_number(text);
  const bool parted = text.skip("/");
  read.count = take_shard_number(text);
  shard = read;
  return parted && text.done() && read.index >= 1 && read.index <= read.count && read.count <= kMaxShards;
}

/// Adds an option for each type of value.
struct Adder {
  CLI::App& app;
  const Option& option;

  CLI::Option* operator()(bool* value) const { return app.add_flag(option.name, *value, option.help); }
  CLI::Option* operator()(std::uint64_t* value) const {
    return app.add_option(option.name, *value, option.help)->transform(CLI::AsSizeValue(false));
  }
  CLI::Option* operator()(std::vector<std::string>* value) const {
    CLI::Option* const added = app.add_option(option.name, *value, option.help);
    return added->get_positional() ? added : added->allow_extra_args(false);
  }
  CLI::Option* operator()(std::optional<Shard>* value) const {
    const auto ignore = [](const std::string&) {};  // the check reads the value
    return app.add_option_function<std::string>(option.name, ignore, option.help)
        ->type_name("k/K")
        ->check([value](const std::string& text) {
          return read_shard(text, *value) ? std::string()
                                          : fmt::format("expected k/K with 1 <= k <= K <= {}", kMaxShards);
        });
  }
  template <class Value>
  CLI::Option* operator()(Value* value) const {
    return app.add_option(option.name, *value, option.help);
  }
};

void add_option(CLI::App& app, const Option& option) {
  CLI::Option* const added = std::visit(Adder{app, option}, option.value);
  if (option.required) added->required();
  if (option.not_empty)
    added->check([](const std::string& value) { return value.empty() ? std::string("an empty name") : std::string(); });
  if (option.not_negative) added->check(CLI::NonNegativeNumber);
  if (option.range) added->check(CLI::Range(option.range->first, option.range->second));
  if (!option.choices.empty()) added->check(CLI::IsMember(option.choices));
  if (option.shows_default) added->capture_default_str();
  if (!option.excludes.empty()) added->excludes(app.get_option(option.excludes));
}

void add_command(CLI::App& app, const Command& command) {
  for (const Option& option : command.options) add_option(app, option);
  app.set_version_flag("--version", patchlight_version());
  if (command.footer) app.footer(command.footer);
  if (!command.subcommands.empty()) app.require_subcommand(1);
  for (const Command& sub : command.subcommands) add_command(*app.add_subcommand(sub.name, sub.purpose), sub);
}

}  // namespace

ParsedCommand parse_command_line(const Command& program, int argc, char** argv) {
  open_standard_streams();
  const auto answer = [&](const std::string& text, int exit_code) -> ParsedCommand {
    try {
      print(text);
      return {exit_code, ""};
    } catch (const Error& error) {
      print_error(fmt::format("{}: error: {}\n", program.name, error.what()));
      return {int(error.code()), ""};
    }
  };
  if (argc == 3 && argv[1] == std::string("--completion")) {
    if (const std::string script = completion_script(program, argv[2]); !script.empty())
      return answer(script, int(ExitCode::ok));
  }
  CLI::App app{program.purpose, program.name};
  add_command(app, program);
  try {
    app.parse(argc, argv);
    const auto chosen = app.get_subcommands();
    return {std::nullopt, chosen.empty() ? "" : chosen.front()->get_name()};
  } catch (const CLI::Success& success) {
    std::ostringstream help;
    const int exit_code = app.exit(success, help, help);
    return answer(help.str(), exit_code);
  } catch (const CLI::ParseError& error) {
    std::string line = program.name;
    for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
    print_error(fmt::format("{}: error: {} ({}): see {} --help\n", program.name, error.what(), line, program.name));
    return {int(ExitCode::usage), ""};
  }
}

}  // namespace patchlight
