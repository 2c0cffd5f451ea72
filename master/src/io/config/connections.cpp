// SPDX-License-Identifier: Apache-2.0
// Reads `connections` and `inputs`.
#include "io/config/load_system.hpp"
#include "mebots/file_kind.hpp"
#include "sections.hpp"

#include <fmt/format.h>

namespace mebots::master::config {
namespace {

std::vector<MappedValue> read_map(const Node& node) {
  std::vector<MappedValue> map;
  for (const auto& [from, to] : node.members()) {
    to.attempt([&, &from = from, &to = to] { map.push_back({from, written_value(to), to.place()}); });
  }
  return map;
}

ConnectionDescription read_connection(const Node& node, const SystemDescription& system) {
  Object object(node);
  ConnectionDescription connection;
  connection.place = node.place();
  object.read("from", connection.from, variable_of(system));
  object.read("to", connection.to, variable_of(system));
  object.read_if("factor", connection.factor, [](const Node& member) {
    const auto factor = member.number();
    if (factor == 0) {
      member.fail(ErrorCode::invalid_value, "a factor of 0 would cut the connection; leave it out instead");
    }
    return factor;
  });
  object.read_if("offset", connection.offset, data::number());
  object.read_if("convert_units", connection.convert_units, &Node::flag);
  object.read_if("narrow", connection.narrow, &Node::flag);
  object.read_if("sum", connection.sum, &Node::flag);
  object.read_if("map", connection.map, read_map);
  object.comment("text");
  object.finish();
  return connection;
}

}  // namespace

void read_connections(const Node& node, SystemDescription& system) {
  system.connections = data::list_of([&](const Node& element) { return read_connection(element, system); })(node);
}

namespace {

SignalColumn read_target(const Node& node, const std::string& column, const SystemDescription& system) {
  SignalColumn target{column, {}, {}, node.place()};
  if (node.is(data::Kind::text)) {
    target.variable = variable_name(node, system);
    return target;
  }
  Object object(node);
  object.read("variable", target.variable, variable_of(system));
  object.read_if("unit", target.unit, &Node::readable_text);
  object.finish();
  return target;
}

/// Reads columns and the inputs that each of them supplies.
std::vector<SignalColumn> read_columns(const Node& node, const SystemDescription& system) {
  std::vector<SignalColumn> columns;
  for (const auto& [column, value] : node.members()) {
    const auto add = [&, &column = column](const Node& target) {
      target.attempt([&] { columns.push_back(read_target(target, column, system)); });
    };
    if (!value.is(data::Kind::list)) {
      add(value);
      continue;
    }
    for (const auto& element : value.elements()) add(element);
  }
  return columns;
}

InputsDescription read_file_of_inputs(const Node& node, const SystemDescription& system) {
  Object object(node);
  InputsDescription inputs;
  object.comment("text");
  inputs.file = read_signal_file(object, system.file.parent_path());
  object.visit_if("to", [&](const Node& to) { inputs.to = read_columns(to, system); });
  object.finish();
  return inputs;
}

}  // namespace

SignalFileDescription read_signal_file(Object& object, const std::filesystem::path& folder) {
  static const auto covers = data::word_of<bool>({{"hold", false}, {"error", true}});
  SignalFileDescription file;
  file.place = object.node().place();
  object.visit("file", [&](const Node& node) {
    file.name = node.readable_text();
    file.path = folder / file.name;
    file.place = node.place();
    if (!is_there(file.path)) {
      node.complain(ErrorCode::file_not_found,
                    fmt::format("there is no file {}; paths are relative to the folder of this file",
                                file.path.lexically_normal().string()));
    }
  });
  object.read_if("time", file.time, &Node::readable_text);
  object.read_if("before", file.covers_start, covers);
  object.read_if("after", file.covers_end, covers);
  return file;
}

void make_signal_paths_absolute(nlohmann::ordered_json& config, const SystemDescription& system) {
  for (std::size_t i = 0; i < system.inputs.size(); ++i) {
    auto& inputs = config["inputs"];
    (inputs.is_array() ? inputs[i] : inputs)["file"] = system.inputs[i].file.path.string();
  }
  for (std::size_t i = 0; i < system.scenario.size(); ++i) {
    const auto& file = system.scenario[i].file;
    if (file) config["scenario"][i]["file"] = file->path.string();
  }
}

void read_inputs(const Node& node, SystemDescription& system) {
  if (node.is(data::Kind::object)) {
    system.inputs.push_back(read_file_of_inputs(node, system));
    return;
  }
  system.inputs = data::list_of([&](const Node& element) { return read_file_of_inputs(element, system); })(node);
}

}  // namespace mebots::master::config
