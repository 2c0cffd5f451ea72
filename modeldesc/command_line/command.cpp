// SPDX-License-Identifier: Apache-2.0
#include "command_line/command.hpp"

#include <CLI/CLI.hpp>

#include <sstream>

namespace mebots::command_line {
namespace {

/// Returns the choices in a type text of CLI11, such as "TEXT:{csv,hdf5}".
std::vector<std::string> choices_in(const std::string& type) {
  std::vector<std::string> choices;
  const auto begin = type.find('{');
  const auto end = type.find('}', begin);
  if (begin == std::string::npos || end == std::string::npos) return choices;
  std::istringstream list(type.substr(begin + 1, end - begin - 1));
  for (std::string choice; std::getline(list, choice, ',');) choices.push_back(choice);
  return choices;
}

Argument argument_of(const CLI::Option& option) {
  Argument argument;
  if (option.get_positional()) {
    argument.names = {option.get_name(true, false)};
  } else {
    for (const auto& name : option.get_snames()) argument.names.push_back("-" + name);
    for (const auto& name : option.get_lnames()) argument.names.push_back("--" + name);
  }
  argument.text = option.get_description();
  argument.required = option.get_required();
  if (option.get_items_expected_max() > 0) {
    const auto type = option.get_type_name();
    argument.value = type.substr(0, type.find(':'));
    argument.choices = choices_in(type);
  }
  return argument;
}

}  // namespace

Command command_of(const CLI::App& app) {
  Command command;
  command.name = app.get_name();
  command.text = app.get_description();
  command.footer = app.get_footer();
  for (const auto* option : app.get_options()) {
    (option->get_positional() ? command.positionals : command.options).push_back(argument_of(*option));
  }
  for (const auto* inner : app.get_subcommands([](const CLI::App*) { return true; })) {
    command.commands.push_back(command_of(*inner));
  }
  return command;
}

}  // namespace mebots::command_line
