#include "pipeline/stage/completion.h"

#include <fmt/format.h>

namespace patchlight {

namespace {

bool is_argument(const Option& option) {
  return option.name.rfind("--", 0) != 0;
}

bool is_flag(const Option& option) {
  return std::holds_alternative<bool*>(option.value);
}

bool is_repeatable(const Option& option) {
  return std::holds_alternative<std::vector<std::string>*>(option.value);
}

/// The name of a shell function for a program.
std::string function_name(const Command& program) {
  std::string name = "_" + program.name;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
}

/// The program itself if it has no subcommands.
std::vector<const Command*> commands(const Command& program) {
  if (program.subcommands.empty()) return {&program};
  std::vector<const Command*> result;
  for (const Command& command : program.subcommands) result.push_back(&command);
  return result;
}

/// Lines of a `case`, from a command's name and the word before, for what completes an option's value.
std::string bash_values(const std::string& pattern, const Command& command) {
  std::string text;
  for (const Option& option : command.options) {
    if (is_argument(option) || is_flag(option)) continue;
    std::string action = "return";  // the shell's default: files
    if (!option.choices.empty())
      action = fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$word\")); return", fmt::join(option.choices, " "));
    if (option.completion == Option::Completion::folder)
      action = "compopt -o filenames; COMPREPLY=($(compgen -d -- \"$word\")); return";
    text += fmt::format("    '{}{}') {} ;;\n", pattern, option.name, action);
  }
  return text;
}

std::string bash_script(const Command& program) {
  const bool has_commands = !program.subcommands.empty();
  std::string values, words, names;
  for (const Command* command : commands(program)) {
    const std::string name = has_commands ? command->name : "";
    values += bash_values(name + " ", *command);
    std::string options = "--help --version";
    for (const Option& option : command->options)
      if (!is_argument(option)) options += " " + option.name;
    words += fmt::format("    '{}') words='{}' ;;\n", name, options);
    names += name + " ";
  }
  const std::string first =
      has_commands ? fmt::format(
                         "  [ \"$COMP_CWORD\" -gt 1 ] || {{ COMPREPLY=($(compgen -W '{}--help --version' -- "
                         "\"$word\")); return; }}\n",
                         names)
                   : "";
  return fmt::format(R"sh(# bash completion for {program}
{function}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command={command} words=
  COMPREPLY=()
{first}  case "$command $before" in
{values}  esac
  case "$command" in
{words}  esac
  [[ $word == -* ]] && COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o bashdefault -o default -F {function} {program}
)sh",
                     fmt::arg("program", program.name), fmt::arg("function", function_name(program)),
                     fmt::arg("command", has_commands ? "${COMP_WORDS[1]}" : ""), fmt::arg("first", first),
                     fmt::arg("values", values), fmt::arg("words", words));
}

/// A help text inside a specification of _arguments, in single quotes.
std::string zsh_quoted(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
      continue;
    }
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_action(const Option& option) {
  if (!option.choices.empty()) return fmt::format("({})", fmt::join(option.choices, " "));
  if (option.completion == Option::Completion::folder) return "_files -/";
  return option.completion == Option::Completion::file ? "_files" : "";
}

std::string zsh_arguments(const Command& command, const std::string& indent) {
  std::string text = indent + "_arguments '--help[Print this help message and exit]' '--version[Print the version]'";
  for (const Option& option : command.options) {
    text += " \\\n" + indent + "  ";
    const char* const star = is_repeatable(option) ? "*" : "";
    if (is_argument(option))
      text += fmt::format("'{}:{}:{}'", star, option.name, zsh_action(option));
    else if (is_flag(option))
      text += fmt::format("'{}[{}]'", option.name, zsh_quoted(option.help));
    else
      text += fmt::format("'{}{}=[{}]:value:{}'", star, option.name, zsh_quoted(option.help), zsh_action(option));
  }
  return text;
}

std::string zsh_script(const Command& program) {
  std::string body;
  if (program.subcommands.empty()) {
    body = zsh_arguments(program, "  ") + "\n";
  } else {
    std::string names, cases;
    for (const Command& command : program.subcommands) {
      names += fmt::format("      '{}:{}'\n", command.name, zsh_quoted(command.purpose));
      cases += fmt::format("    {})\n{} ;;\n", command.name, zsh_arguments(command, "      "));
    }
    body = fmt::format(R"zsh(  if (( CURRENT == 2 )); then
    local -a commands=(
{}    )
    _describe command commands
    _arguments '--help[Print this help message and exit]' '--version[Print the version]'
    return
  fi
  shift words
  (( CURRENT-- ))
  case $words[1] in
{}  esac
)zsh",
                       names, cases);
  }
  const std::string function = function_name(program);
  return fmt::format("#compdef {0}\n{1}() {{\n{2}}}\n{1} \"$@\"\n", program.name, function, body);
}

}  // namespace

std::string completion_script(const Command& program, const std::string& shell) {
  if (shell == "bash") return bash_script(program);
  return shell == "zsh" ? zsh_script(program) : "";
}

}  // namespace patchlight
