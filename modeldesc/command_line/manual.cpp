// SPDX-License-Identifier: Apache-2.0
#include "command_line/command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace mebots::command_line {
namespace {

/// Escapes text for troff. Prints backslashes and hyphens literally, and prevents a control character at the start of a
/// line.
std::string plain(const std::string& text) {
  std::string result;
  for (const char character : text) {
    if (character == '\\') {
      result += "\\e";
    } else if (character == '-') {
      result += "\\-";
    } else {
      result += character;
    }
  }
  if (!result.empty() && (result.front() == '.' || result.front() == '\'')) result.insert(0, "\\&");
  return result;
}

std::string in_capitals(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char character) { return std::toupper(character); });
  return text;
}

/// Returns a heading such as "\fB--out\fR \fITEXT\fR".
std::string heading_of(const Argument& argument) {
  std::vector<std::string> names;
  for (const auto& name : argument.names) names.push_back("\\fB" + plain(name) + "\\fR");
  auto heading = fmt::format("{}", fmt::join(names, ", "));
  if (!argument.choices.empty())
    return heading + fmt::format(" {{{}}}", plain(fmt::format("{}", fmt::join(argument.choices, ","))));
  if (!argument.value.empty()) heading += " \\fI" + plain(argument.value) + "\\fR";
  return heading;
}

std::string list_of(const std::string& title, const std::vector<Argument>& arguments) {
  if (arguments.empty()) return {};
  std::string text = ".SH " + title + "\n";
  for (const auto& argument : arguments) text += ".TP\n" + heading_of(argument) + "\n" + plain(argument.text) + "\n";
  return text;
}

/// Converts the footer of a program's help to sections of its manual page. A line that ends with a colon becomes a
/// section title. Lines that are indented by two spaces keep their line breaks.
std::string sections_of(const std::string& footer) {
  std::string text;
  bool is_literal = false;
  const auto begin = [&](bool stands) {
    if (stands != is_literal) text += stands ? ".nf\n" : ".fi\n";
    is_literal = stands;
  };
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    begin(line.starts_with("  "));
    if (is_literal) {
      text += plain(line.substr(2)) + "\n";
    } else if (line.ends_with(':')) {
      text += ".SH " + in_capitals(line.substr(0, line.size() - 1)) + "\n";
    } else {
      text += ".PP\n" + plain(line) + "\n";
    }
  }
  begin(false);
  return text;
}

std::string synopsis_of(const Command& command, const std::string& words) {
  std::string text = fmt::format(".SH SYNOPSIS\n.B {}\n", plain(words));
  if (!command.options.empty()) text += "[\\fIOPTIONS\\fR]\n";
  for (const auto& argument : command.positionals) {
    const auto name = "\\fI" + plain(argument.names.front()) + "\\fR";
    text += argument.required ? name + "\n" : "[" + name + "]\n";
  }
  if (!command.commands.empty()) text += "\\fICOMMAND\\fR ...\n";
  return text;
}

}  // namespace

std::string manual_page(const Command& command, const std::string& program, const std::string& version) {
  const bool whole = command.name == program;
  const auto page = whole ? program : program + "-" + command.name;
  std::string text = fmt::format(".TH {} 1 \"\" \"MEbots {}\" \"MEbots\"\n", in_capitals(plain(page)), version);
  text += fmt::format(".SH NAME\n{} \\- {}\n", plain(page), plain(command.text));
  text += synopsis_of(command, whole ? program : program + " " + command.name);
  text += list_of("ARGUMENTS", command.positionals);
  text += list_of("OPTIONS", command.options);
  if (!command.commands.empty()) {
    text += ".SH COMMANDS\n";
    for (const auto& inner : command.commands) {
      text += fmt::format(".TP\n\\fB{}\\fR(1)\n{}\n", plain(page + "-" + inner.name), plain(inner.text));
    }
  }
  text += sections_of(command.footer);
  if (!whole) text += fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n", plain(program));
  return text;
}

}  // namespace mebots::command_line
