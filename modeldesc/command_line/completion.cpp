// SPDX-License-Identifier: Apache-2.0
#include "command_line/command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace mebots::command_line {
namespace {

/// Returns the text in single quotes. `quote` replaces each single quote in the text. Inside single quotes, bash and
/// zsh interpret no other character. fish also interprets a backslash before a backslash or a single quote.
std::string quoted(const std::string& text, const std::string& quote) {
  std::string result = "'";
  for (const char character : text) {
    if (character == '\'') {
      result += quote;
    } else {
      result += character;
    }
  }
  return result + "'";
}

std::string in_bash(const std::string& text) {
  return quoted(text, "'\\''");
}
std::string in_fish(const std::string& text) {
  return quoted(text, "\\'");
}

/// Escapes colons, brackets and backslashes, because zsh's _arguments and _describe would interpret them.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char character : text) {
    if (character == ':' || character == '[' || character == ']' || character == '\\') result += '\\';
    result += character;
  }
  return result;
}

/// Returns the name of the program's shell function: '_' and the program's name, with '_' in place of '-'.
std::string function_of(const Command& program) {
  auto name = "_" + program.name;
  std::ranges::replace(name, '-', '_');
  return name;
}

std::vector<std::string> names_of(const std::vector<Argument>& options) {
  std::vector<std::string> names;
  for (const auto& option : options) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

/// Returns the bash code that completes the arguments of one command. After an option with listed values, the code
/// offers these values. After an option with another value, the code offers files. After a dash, the code offers
/// options.
std::string bash_case(const Command& command, const std::string& pattern) {
  std::string text = fmt::format("    {})\n      case $before in\n", pattern);
  std::vector<std::string> with_value;
  for (const auto& option : command.options) {
    const auto names = fmt::format("{}", fmt::join(option.names, "|"));
    if (!option.choices.empty()) {
      text +=
          fmt::format("        {}) choices={} ;;\n", names, in_bash(fmt::format("{}", fmt::join(option.choices, " "))));
    } else if (!option.value.empty()) {
      with_value.push_back(names);
    }
  }
  if (!with_value.empty()) text += fmt::format("        {}) options= ;;\n", fmt::join(with_value, "|"));
  text += fmt::format("        *) options={} ;;\n      esac\n      ;;\n",
                      in_bash(fmt::format("{}", fmt::join(names_of(command.options), " "))));
  return text;
}

/// Returns the lines for fish that declare a command's options. Each line begins with `start`, which contains the
/// condition for the option.
std::string fish_options(const Command& command, const std::string& start) {
  std::string text;
  for (const auto& option : command.options) {
    text += start;
    for (const auto& name : option.names)
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!option.choices.empty()) {
      text += " -x -a " + in_fish(fmt::format("{}", fmt::join(option.choices, " ")));
    } else if (!option.value.empty()) {
      text += " -r";
    }
    text += " -d " + in_fish(option.text) + "\n";
  }
  return text;
}

/// Returns the arguments of zsh's _arguments that declare a command's options and files.
std::string zsh_arguments(const Command& command) {
  std::string text;
  for (const auto& option : command.options) {
    const bool repeats = option.value.ends_with("...");
    std::string value;
    if (!option.choices.empty()) {
      value = fmt::format(":value:({})", fmt::join(option.choices, " "));
    } else if (!option.value.empty()) {
      value = ":value:_files";
    }
    for (const auto& name : option.names) {
      const auto word = fmt::format("{}{}[{}]{}", repeats ? "*" : "", name, escaped(option.text), value);
      text += fmt::format(" \\\n          {}", in_bash(word));
    }
  }
  return text + " \\\n          '*:file:_files'";
}

std::string zsh_end(const Command& program) {
  return fmt::format(R"(}}
if [[ $funcstack[1] == {0} ]]; then
  {0} "$@"
else
  compdef {0} {1}
fi
)",
                     function_of(program), program.name);
}

}  // namespace

std::string bash_completion(const Command& program) {
  const auto function = function_of(program);
  std::vector<std::string> commands;
  for (const auto& command : program.commands) commands.push_back(command.name);
  std::string text = fmt::format(R"(# Completion of {0} for bash. Made by `{0} --print-completion bash`.
{1}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command= choices= options= i
)",
                                 program.name, function);
  if (program.commands.empty()) {
    text += "  case $command in\n" + bash_case(program, "''");
  } else {
    text += fmt::format(R"(  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${{COMP_WORDS[i]}} != -* ]]; then
      command=${{COMP_WORDS[i]}}
      break
    fi
  done
  case $command in
    '')
      choices={}
      options={}
      ;;
)",
                        in_bash(fmt::format("{}", fmt::join(commands, " "))),
                        in_bash(fmt::format("{}", fmt::join(names_of(program.options), " "))));
  }
  for (const auto& command : program.commands) text += bash_case(command, command.name);
  text += fmt::format(R"(  esac
  if [[ $word == -* && -n $options ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  elif [[ -n $choices ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    compopt -o filenames 2>/dev/null
  fi
}}
complete -F {0} {1}
)",
                      function, program.name);
  return text;
}

std::string fish_completion(const Command& program) {
  std::string text =
      fmt::format("# Completion of {0} for fish. Made by `{0} --print-completion fish`.\n", program.name);
  if (program.commands.empty()) return text + fish_options(program, "complete -c " + program.name);
  const auto start = "complete -c " + program.name + " -n ";
  text += fish_options(program, start + "__fish_use_subcommand");
  for (const auto& command : program.commands) {
    text += fmt::format("{}__fish_use_subcommand -f -a {} -d {}\n", start, command.name, in_fish(command.text));
  }
  for (const auto& command : program.commands) {
    text += fish_options(command, start + in_fish("__fish_seen_subcommand_from " + command.name));
  }
  return text;
}

std::string zsh_completion(const Command& program) {
  const auto function = function_of(program);
  std::string text = fmt::format(R"(#compdef {0}
# Completion of {0} for zsh. Made by `{0} --print-completion zsh`.
{1}() {{
  local context state state_descr line
  local -A opt_args
)",
                                 program.name, function);
  if (program.commands.empty()) return text + "  _arguments" + zsh_arguments(program) + "\n" + zsh_end(program);
  text += "  local -a commands=(\n";
  for (const auto& command : program.commands) {
    text += "    " + in_bash(command.name + ":" + escaped(command.text)) + "\n";
  }
  text += R"(  )
  _arguments -C '1:command:->command' '*::argument:->argument'
  case $state in
    command) _describe command commands ;;
    argument)
      case $line[1] in
)";
  for (const auto& command : program.commands) {
    text += fmt::format("        {})\n          _arguments{}\n          ;;\n", command.name, zsh_arguments(command));
  }
  text += "      esac\n      ;;\n  esac\n";
  return text + zsh_end(program);
}

}  // namespace mebots::command_line
