// SPDX-License-Identifier: Apache-2.0
#include "cases/case_file.hpp"

#include "base/input_text.hpp"
#include "io/config/sections.hpp"
#include "mebots/data/document.hpp"
#include "mebots/file_kind.hpp"
#include "model/resolved_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::master::cases {
namespace {

using data::Node;
using data::Object;

std::filesystem::path existing_file(const Node& node, const std::filesystem::path& folder) {
  auto file = folder / node.readable_text();
  if (!is_file(file)) {
    node.complain(ErrorCode::file_not_found,
                  fmt::format("there is no file {}; paths are relative to the folder of this file",
                              file.lexically_normal().string()));
  }
  return file;
}

/// Reads one path or a list of paths.
std::vector<std::filesystem::path> read_inputs(const Node& node, const std::filesystem::path& folder) {
  const auto read_one = [&](const Node& element) { return existing_file(element, folder); };
  if (node.is(data::Kind::list)) return data::list_of(read_one)(node);
  return {read_one(node)};
}

Tolerance read_tolerance(const Node& node, Tolerance tolerance) {
  Object object(node);
  object.read_if("absolute", tolerance.absolute, data::number(data::Limits::at_least(0)));
  object.read_if("relative", tolerance.relative, data::number(data::Limits::at_least(0)));
  object.finish();
  return tolerance;
}

std::vector<VariableTolerance> read_tolerances(const Node& node, const Tolerance& usual) {
  std::vector<VariableTolerance> tolerances;
  for (const auto& [pattern, member] : node.members()) {
    member.attempt([&, &pattern = pattern, &member = member] {
      tolerances.push_back({pattern, read_tolerance(member, usual)});
    });
  }
  return tolerances;
}

std::vector<Setting> read_parameters(const Node& node) {
  std::vector<Setting> settings;
  for (const auto& [variable, value] : node.members()) {
    value.attempt([&, &variable = variable, &value = value] {
      settings.push_back({variable, config::written_value(value), value.place()});
    });
  }
  return settings;
}

/// Checks a step, and returns it as the file contains it: a number, or a ratio such as "1/60" as a text. The run needs
/// this form, because it adds a notice if it interprets a decimal number as a ratio.
WrittenTime read_step(const Node& node) {
  static_cast<void>(config::step_time(node));
  if (node.is(data::Kind::text)) return node.text();
  return node.number();
}

bool is_folder_name(std::string_view name) {
  const auto is_bad = [](char c) { return c == '/' || static_cast<unsigned char>(c) < ' '; };
  return !name.empty() && name.front() != '.' && std::ranges::none_of(name, is_bad);
}

CaseDescription read_case(const std::string& name, const Node& node, const std::filesystem::path& folder,
                          const Tolerance& usual) {
  Object object(node);
  CaseDescription description;
  description.name = name;
  if (!is_folder_name(name)) {
    node.complain(ErrorCode::invalid_value,
                  "the name of a case is the name of a folder for its results: it must not be empty, begin with a dot, "
                  "or contain a slash or control characters");
  }
  description.tolerance = usual;
  object.comment("text");
  object.read_if("inputs", description.inputs, [&](const Node& inputs) { return read_inputs(inputs, folder); });
  object.read("expected", description.expected, [&](const Node& file) { return existing_file(file, folder); });
  object.read_if("parameters", description.parameters, &read_parameters);
  object.read_if("step", description.step, &read_step);
  object.read_if("stop_time", description.stop_time_ns, &config::time_ns);
  object.read_if("tolerance", description.tolerance,
                 [&](const Node& tolerance) { return read_tolerance(tolerance, usual); });
  object.read_if("tolerances", description.tolerances,
                 [&](const Node& tolerances) { return read_tolerances(tolerances, description.tolerance); });
  object.finish();
  return description;
}

CaseFile read_root(const Node& root, const std::filesystem::path& folder) {
  Object object(root);
  CaseFile file{.folder = folder};
  Tolerance usual;
  object.comment("$schema");
  object.comment("text");
  object.read_if("fmu", file.fmu, &Node::readable_text);
  object.read_if("tolerance", usual, [&](const Node& node) { return read_tolerance(node, usual); });
  object.visit("cases", [&](const Node& node) {
    for (const auto& [name, member] : node.members()) {
      member.attempt(
          [&, &name = name, &member = member] { file.cases.push_back(read_case(name, member, folder, usual)); });
    }
    if (node.members().empty())
      node.fail(ErrorCode::invalid_value, "there is nothing to test; write at least one case");
  });
  object.finish();
  return file;
}

}  // namespace

double Tolerance::of(double expected) const {
  return absolute + relative * std::abs(expected);
}

Tolerance CaseDescription::tolerance_of(std::string_view variable) const {
  auto result = tolerance;
  for (const auto& [pattern, own] : tolerances) {
    if (fits(variable, pattern)) result = own;
  }
  return result;
}

CaseFile read_cases(const std::filesystem::path& file) {
  const auto folder = std::filesystem::absolute(file).parent_path();
  return refused_as_input(
      [&] { return data::Document(file).read([&](const Node& root) { return read_root(root, folder); }); });
}

}  // namespace mebots::master::cases
