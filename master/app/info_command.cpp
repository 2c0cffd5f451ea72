// SPDX-License-Identifier: Apache-2.0
#include "base/time.hpp"
#include "command.hpp"
#include "engine/algorithm/algorithm.hpp"
#include "io/config/load_system.hpp"
#include "io/fmu_archive.hpp"
#include "io/fmu_terminals.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/units.hpp"
#include "mebots/nearest_names.hpp"
#include "model/resolved_system.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

using namespace mebots::modeldesc;

/// Returns the sizes of an array, such as [3]. If a structural parameter n determines a size, its name replaces the
/// number: [n].
std::string dimensions_text(const ModelDescription& model, const Variable& variable) {
  std::vector<std::string> sizes;
  for (const auto& dimension : variable.fmi3->dimensions) {
    if (dimension.start) {
      sizes.push_back(fmt::format("{}", *dimension.start));
      continue;
    }
    const auto found = std::ranges::find(model.variables, *dimension.value_reference, &Variable::value_reference);
    sizes.push_back(found == model.variables.end() ? "?" : found->name);
  }
  return sizes.empty() ? std::string() : fmt::format("[{}]", fmt::join(sizes, ","));
}

std::string shown(const ModelDescription& model, const Variable& variable) {
  const auto show = [&](const modeldesc::Value& value) {
    const auto text = master::value_text(variable.type, value);
    return std::holds_alternative<std::string>(value) ? fmt::format("\"{}\"", text) : text;
  };
  if (const auto* type = model.type_definition(variable.declared_type);
      type != nullptr && std::holds_alternative<std::int64_t>(variable.start)) {
    for (const auto& item : type->items) {
      if (item.value == std::get<std::int64_t>(variable.start)) return item.name;
    }
  }
  if (variable.fmi3->starts.size() > 1) {
    std::vector<std::string> all;
    for (const auto& start : variable.fmi3->starts) all.push_back(show(start));
    return fmt::format("{}", fmt::join(all, " "));
  }
  return show(variable.start);
}

std::string range_text(const Variable& variable) {
  if (!variable.min && !variable.max) return {};
  return fmt::format("{} .. {}", variable.min ? fmt::format("{}", *variable.min) : "",
                     variable.max ? fmt::format("{}", *variable.max) : "");
}

void print_field(std::string_view label, std::string_view text) {
  if (!text.empty()) fmt::print("{:<18}{}\n", label, text);
}

void print_flags(const CoSimulation& co_simulation) {
  std::vector<std::string> yes;
  const auto flag = [&](bool value, const char* name) {
    if (value) yes.emplace_back(name);
  };
  flag(co_simulation.can_handle_variable_communication_step_size, "variable step");
  flag(co_simulation.can_get_and_set_fmu_state, "saves state");
  flag(co_simulation.can_serialize_fmu_state, "serialises state");
  flag(co_simulation.can_interpolate_inputs, "interpolates inputs");
  flag(co_simulation.provides_directional_derivative, "directional derivatives");
  flag(co_simulation.can_run_asynchronuously, "asynchronous steps");
  flag(co_simulation.can_be_instantiated_only_once_per_process, "one instance per process");
  flag(co_simulation.needs_execution_tool, "needs its tool");
  print_field("co-simulation", fmt::format("{} ({})", co_simulation.model_identifier, fmt::join(yes, ", ")));
}

void print_flags(const ModelDescription& model, const ModelExchange& exchange) {
  std::vector<std::string> facts = {fmt::format("{} states", model.derivatives.size()),
                                    fmt::format("{} event indicators", model.number_of_event_indicators)};
  const auto flag = [&](bool value, const char* name) {
    if (value) facts.emplace_back(name);
  };
  flag(exchange.can_get_and_set_fmu_state, "saves state");
  flag(exchange.can_serialize_fmu_state, "serialises state");
  flag(exchange.provides_directional_derivative, "directional derivatives");
  flag(exchange.can_be_instantiated_only_once_per_process, "one instance per process");
  flag(exchange.needs_execution_tool, "needs its tool");
  print_field("model exchange", fmt::format("{} ({})", exchange.model_identifier, fmt::join(facts, ", ")));
}

void print_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i + 1 < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) line += fmt::format("{:<{}}  ", row[i], widths[i]);
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
  }
}

void print_variables(const ModelDescription& model) {
  std::vector<std::vector<std::string>> rows = {
      {"variable", "causality", "variability", "type", "unit", "start", "range", "text"}};
  constexpr Causality kOrder[] = {
      Causality::structural_parameter, Causality::parameter, Causality::input,      Causality::output,
      Causality::calculated_parameter, Causality::local,     Causality::independent};
  for (const auto causality : kOrder) {
    for (const auto& variable : model.variables) {
      if (variable.causality != causality) continue;
      const bool named_type = variable.type == Type::enumeration && !variable.declared_type.empty();
      rows.push_back({variable.name + dimensions_text(model, variable), std::string(to_string(variable.causality)),
                      std::string(to_string(variable.variability)),
                      named_type ? variable.declared_type : std::string(to_string(variable.type)), variable.unit,
                      shown(model, variable), range_text(variable), variable.text});
    }
  }
  print_table(rows);
}

void print_types(const ModelDescription& model) {
  for (const auto& type : model.types) {
    if (type.items.empty()) continue;
    std::vector<std::string> items;
    for (const auto& item : type.items) items.push_back(fmt::format("{} = {}", item.name, item.value));
    print_field("enumeration", fmt::format("{}: {}", type.name, fmt::join(items, ", ")));
  }
}

void print_description(const ModelDescription& model) {
  print_field("name", model.model_name);
  print_field("text", model.text);
  print_field("FMI version", model.fmi_version);
  print_field("version", model.version);
  print_field("GUID", model.guid);
  print_field("author", model.author);
  print_field("license", model.license);
  print_field("made by", model.generation_tool);
  print_field("made at", model.generation_date_and_time);
  if (model.co_simulation) print_flags(*model.co_simulation);
  if (model.model_exchange) print_flags(model, *model.model_exchange);
  const auto& experiment = model.default_experiment;
  if (experiment.start_time_s) print_field("start time", fmt::format("{} s", *experiment.start_time_s));
  if (experiment.step_size_s) print_field("step", fmt::format("{} s", *experiment.step_size_s));
  if (experiment.stop_time_s) print_field("stop time", fmt::format("{} s", *experiment.stop_time_s));
  for (const auto& category : model.log_categories) {
    print_field("log category",
                category.text.empty() ? category.name : fmt::format("{}: {}", category.name, category.text));
  }
  print_types(model);
  const auto count = [&](Causality causality) {
    return std::count_if(model.variables.begin(), model.variables.end(),
                         [&](const Variable& variable) { return variable.causality == causality; });
  };
  print_field("variables", fmt::format("{} ({} parameters, {} inputs, {} outputs)", model.variables.size(),
                                       count(Causality::parameter), count(Causality::input), count(Causality::output)));
}

/// Returns the kind of a Clock as FMI 3.0 names it.
std::string_view clock_kind(IntervalVariability variability) {
  switch (variability) {
    case IntervalVariability::constant:
    case IntervalVariability::fixed:
    case IntervalVariability::tunable:
      return "periodic";
    case IntervalVariability::changing:
      return "aperiodic";
    case IntervalVariability::countdown:
      return "countdown";
    case IntervalVariability::triggered:
      break;
  }
  return "triggered";
}

/// Returns the interval of a Clock in seconds. Empty if only the running FMU determines the interval.
std::string interval_text(const ClockTiming& timing) {
  if (timing.interval_counter && timing.resolution)
    return fmt::format("{}/{}", *timing.interval_counter, *timing.resolution);
  return timing.interval_s ? fmt::format("{}", *timing.interval_s) : std::string();
}

std::string shift_text(const ClockTiming& timing) {
  if (timing.shift_counter && timing.resolution) return fmt::format("{}/{}", *timing.shift_counter, *timing.resolution);
  return timing.is_time_based() ? fmt::format("{}", timing.shift_s) : std::string();
}

/// Prints a table of the Clocks with the variables that may change at their ticks.
void print_clocks(const ModelDescription& model) {
  std::vector<std::vector<std::string>> rows = {
      {"clock", "causality", "kind", "interval is", "interval [s]", "shift [s]", "variables"}};
  for (const auto& clock : model.variables) {
    if (clock.type != Type::clock) continue;
    std::vector<std::string> members;
    for (const auto& variable : model.variables) {
      if (std::ranges::find(variable.fmi3->clocks, clock.value_reference) != variable.fmi3->clocks.end())
        members.push_back(variable.name);
    }
    const auto& timing = *clock.fmi3->timing;
    const auto kind = clock_kind(timing.interval_variability);
    const auto word = kIntervalVariabilityWords[static_cast<std::size_t>(timing.interval_variability)];
    rows.push_back({clock.name, std::string(to_string(clock.causality)), std::string(kind),
                    word == kind ? std::string() : std::string(word), interval_text(timing), shift_text(timing),
                    fmt::format("{}", fmt::join(members, ", "))});
  }
  if (rows.size() == 1) return;
  fmt::print("\n");
  print_table(rows);
}

void print_terminals(const std::vector<DeclaredTerminal>& terminals) {
  if (terminals.empty()) return;
  fmt::print("\n");
  std::vector<std::vector<std::string>> rows = {{"terminal", "kind", "rule", "member", "variable", "text"}};
  for (const auto& terminal : terminals) {
    for (const auto& member : terminal.members) {
      const bool first = &member == &terminal.members.front();
      rows.push_back({first ? terminal.name : "", first ? terminal.kind : "", first ? terminal.matching_rule : "",
                      member.name, member.variable, first ? terminal.text : ""});
    }
  }
  print_table(rows);
}

void print_system(const master::SystemDescription& system) {
  print_field("step", fmt::format("{} s", master::time_text(system.step)));
  if (const auto& control = system.step_control) {
    print_field("step control", fmt::format("{} to {} s", master::time_text(system.length_of(control->min_steps)),
                                            master::time_text(system.length_of(control->max_steps))));
  }
  if (system.start_time_ns != 0)
    print_field("start time", fmt::format("{} s", master::to_seconds(system.start_time_ns)));
  print_field("stop time", fmt::format("{} s", master::to_seconds(system.stop_time_ns)));
  print_field("algorithm", master::find_algorithm(system.algorithm).name);
  for (const auto& notice : system.notices) print_field("notice", notice);
  fmt::print("\n");
  std::vector<std::vector<std::string>> instances{{"instance", "fmu", "step [s]", "values given"}};
  for (const auto& instance : system.instances) {
    instances.push_back({instance.name, instance.fmu_path.filename().string(),
                         master::time_text(system.step_of(instance)), fmt::format("{}", instance.parameters.size())});
  }
  print_table(instances);
  fmt::print("\n");
  std::vector<std::vector<std::string>> connections{{"from", "to", "factor", "offset", ""}};
  for (const auto& connection : system.connections) {
    connections.push_back({connection.from.text(), connection.to.text(), fmt::format("{}", connection.factor),
                           fmt::format("{}", connection.offset),
                           connection.sum            ? "added up"
                           : !connection.map.empty() ? "mapped"
                                                     : ""});
  }
  print_table(connections);
}

void info(const std::filesystem::path& file) {
  if (!is_there(file)) {
    throw InputError(ErrorCode::file_not_found, fmt::format("{}: there is no such file", file.string()));
  }
  if (master::may_be_system(file)) {
    print_system(master::read_config(file));
  } else {
    const auto description = master::read_fmu_description(file);
    print_description(description);
    fmt::print("\n");
    print_variables(description);
    print_clocks(description);
    print_terminals(master::read_fmu_terminals(file));
  }
  print_product("");  // flushes the output
}

}  // namespace

void add_info(CLI::App& app, Action& action) {
  const auto file = std::make_shared<std::filesystem::path>();
  auto* command = app.add_subcommand("info", "Show what an FMU, a config or an SSP contains");
  command
      ->add_option("file", *file,
                   "FMU (.fmu), config (.json), SSP (.ssp, .ssd or its folder) or OspSystemStructure.xml")
      ->type_name("FILE")
      ->required();
  command->footer(help_footer({"0 shown", "1 standard output is closed or full", "2 the file cannot be used"},
                              {"mebots info fmu_battery.fmu", "mebots info configs/gate_easy.json"}));
  command->callback([file, &action] { action = [file] { return guarded([&] { info(*file); }); }; });
}

namespace {

void print_units() {
  std::string text = fmt::format("{:<6} {:<22} {:<18} {:>24} {:>8}\n", "unit", "", "SI base", "factor", "offset");
  for (const auto& known : modeldesc::known_units()) {
    const auto& unit = known.unit;
    text += fmt::format("{:<6} {:<22} {:<18} {:>24} {:>8}\n", unit.name, known.text, modeldesc::base_unit_text(unit),
                        unit.factor, unit.offset);
  }
  text +=
      "\nvalue in SI units = factor x value + offset. Products of powers of these are units, too, in the notation of "
      "FMI:\n"
      "m/s2, kg.m2, rad/(s.V), 1/s, s-1. In a product a unit with an offset counts as a difference.\n";
  print_product(text);
}

}  // namespace

void add_units(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand("units", "List the units that a description may use, with dimension and factor");
  command->footer(help_footer({"0 printed", "1 standard output is closed or full"}, {"mebots units"}));
  command->callback([&action] { action = [] { return guarded(&print_units); }; });
}

namespace {

void print_schema(const std::string& kind) {
  const auto all = master::schemas();
  const auto found = std::ranges::find(all, kind, &master::Schema::kind);
  if (found == all.end()) {
    std::vector<std::string> known;
    for (const auto& schema : all) known.emplace_back(schema.kind);
    throw InputError(ErrorCode::unknown_name, "there is no kind of file '" + kind + "'. " + suggest(kind, known));
  }
  print_product(found->text);
}

}  // namespace

void add_schema(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand("schema", "Print the JSON schema of a kind of file");
  const auto kind = std::make_shared<std::string>("config");
  std::string kinds;
  for (const auto& schema : master::schemas()) kinds += (kinds.empty() ? "" : ", ") + std::string(schema.kind);
  command->add_option("kind", *kind, "Kind of file: " + kinds)->type_name("KIND")->capture_default_str();
  command->footer(help_footer({"0 printed", "1 standard output is closed or full", "2 there is no such kind of file"},
                              {"mebots schema > mebots-config.schema.json", "mebots schema board"}));
  command->callback([&action, kind] { action = [kind] { return guarded([&] { print_schema(*kind); }); }; });
}

}  // namespace mebots::app
