// SPDX-License-Identifier: Apache-2.0
#include "resolve/signal_coverage.hpp"

#include "base/input_text.hpp"
#include "base/time.hpp"
#include "io/signal_file.hpp"
#include "mebots/modeldesc/units.hpp"
#include "mebots/nearest_names.hpp"
#include "model/value_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <list>
#include <optional>
#include <utility>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

[[noreturn]] void fail(const std::string& place, ErrorCode code, const std::string& what) {
  throw InputError(code, fmt::format("{}: {}", place, what));
}

/// Determines the conversion from the unit of a column to a variable. Units of the FMU, including display units, take
/// precedence over units of mebots.
class ColumnUnit {
 public:
  ColumnUnit(const modeldesc::ModelDescription& model, const modeldesc::Variable& variable, std::string unit,
             std::string place)
      : model_(model), variable_(variable), unit_(std::move(unit)), place_(std::move(place)) {}

  modeldesc::UnitConversion conversion() const {
    if (!fmi::is_float(variable_.type))
      refuse(fmt::format("a variable of type {} has no unit", to_string(variable_.type)));
    if (unit_ == variable_.unit || variable_.unit.empty()) return {};
    const auto* to = model_.unit(variable_.unit);
    if (to == nullptr || !to->has_base) {
      refuse(fmt::format("{} does not define [{}]; write the values in [{}]", model_.model_name, variable_.unit,
                         variable_.unit));
    }
    for (const auto& display : to->display_units) {
      if (display.name == unit_) return {1 / display.factor, difference() ? 0 : -display.offset / display.factor};
    }
    const auto from = unit();
    if (!modeldesc::same_dimension(from, *to)) {
      refuse(fmt::format("[{}] is {} and [{}] is {}", unit_, modeldesc::base_unit_text(from), variable_.unit,
                         modeldesc::base_unit_text(*to)));
    }
    return modeldesc::unit_conversion(from, *to, difference());
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    fail(place_, ErrorCode::wrong_unit,
         fmt::format("the column is in [{}] and cannot be converted for '{}': {}", unit_, variable_.name, why));
  }
  bool difference() const { return variable_.relative_quantity; }
  modeldesc::Unit unit() const {
    const auto* own = model_.unit(unit_);
    if (own != nullptr && own->has_base) return *own;
    try {
      return modeldesc::parse_unit(unit_);
    } catch (const Error& error) {
      fail(place_, error.code(), error.what());
    }
  }

  const modeldesc::ModelDescription& model_;
  const modeldesc::Variable& variable_;
  std::string unit_;
  std::string place_;
};

/// Reads the signal files of a system. Collects the needed signals first, so that each file is read once.
class SignalReader {
 public:
  explicit SignalReader(ResolvedSystem& system) : system_(system) {}

  void read() {
    const auto& description = *system_.description;
    for (const auto& inputs : description.inputs) add_inputs(inputs);
    system_.scenario_signals.resize(description.scenario.size());
    for (std::size_t i = 0; i < description.scenario.size(); ++i) {
      if (description.scenario[i].action == OverrideAction::signal) add_entry(i);
    }
    for (auto& opened : files_) finish(opened);
  }

 private:
  struct Use {
    OverrideDescription description;
    ResolvedVariable variable;
    std::optional<std::size_t> entry;  // index in the scenario; nullopt for an input
  };
  struct Opened {
    Opened(const SignalFileDescription& asked) : description(asked), file(asked.path, asked.name, asked.time) {}

    SignalFileDescription description;
    SignalFile file;
    std::vector<WantedSignal> wanted;
    std::vector<Use> uses;
  };

  Opened& open(const SignalFileDescription& asked) {
    for (auto& opened : files_) {
      if (opened.description.path == asked.path && opened.description.time == asked.time) return opened;
    }
    try {
      return files_.emplace_back(asked);
    } catch (const InputError& error) {
      fail(asked.place, error.code(), error.what());
    }
  }

  void add_inputs(const InputsDescription& inputs) {
    auto& opened = open(inputs.file);
    std::vector<SignalColumn> columns;
    if (inputs.to) {
      columns = *inputs.to;
    } else {
      for (std::size_t i = 0; i < opened.file.titles().size(); ++i) {
        if (i == opened.file.time_column()) continue;
        const auto& name = opened.file.titles()[i].name;
        const auto place = fmt::format("{}: {}: column {}", inputs.file.place, opened.file.name(), i + 1);
        columns.push_back({name, parse_variable(*system_.description, name, place), {}, place});
      }
    }
    for (const auto& column : columns) add_input(opened, inputs.file, column);
  }

  void add_input(Opened& opened, const SignalFileDescription& file, const SignalColumn& column) {
    OverrideDescription description;
    description.variable = column.variable;
    description.action = OverrideAction::signal;
    description.file = file;
    description.column = column.column;
    description.unit = column.unit;
    description.from_ns = system_.description->start_time_ns;
    description.place = column.place;
    const auto variable = system_.find(column.variable, column.place);
    check_free(variable, column.place);
    system_.inputs.emplace(variable, InputSignal{description, nullptr});
    add(opened, {std::move(description), variable, std::nullopt});
  }

  void add_entry(std::size_t entry) {
    const auto& description = system_.description->scenario[entry];
    auto& opened = open(*description.file);
    add(opened, {description, system_.find(description.variable, description.place + "/variable"), entry});
  }

  void check_free(const ResolvedVariable& input, const std::string& place) const {
    const auto name = system_.text(input);
    if (input.variable->causality != Causality::input) {
      fail(place, ErrorCode::invalid_value,
           fmt::format("'{}' has causality {}, but a column of a file can only be the source of an input", name,
                       to_string(input.variable->causality)));
    }
    const auto& model = *system_.instances[input.instance].model;
    if (is_osmp_part(model, *input.variable)) {
      fail(place, ErrorCode::invalid_value, fmt::format("'{}' is part of a binary variable", name));
    }
    const auto connection = std::ranges::lower_bound(system_.connections, input, {}, &ResolvedConnection::to);
    if (connection != system_.connections.end() && connection->to == input) {
      fail(place, ErrorCode::invalid_connection,
           fmt::format("'{}' gets its value from {}, so the column would have no effect; remove the connection, or use "
                       "\"signal\" in a scenario",
                       name, system_.text(connection->from)));
    }
    if (const auto* other = system_.input_signal(input); other != nullptr) {
      fail(place, ErrorCode::invalid_connection,
           fmt::format("'{}' has another column as its source (at {}); keep one of them", name,
                       other->description.place));
    }
    const auto& given = system_.instances[input.instance].description->parameters;
    const auto value = std::ranges::find(given, input.variable->name, &Assignment::variable);
    if (value != given.end()) {
      fail(value->place, ErrorCode::invalid_value,
           fmt::format("'{}' gets its value from {}, so the value given here would have no effect; remove one of them",
                       name, place));
    }
  }

  void add(Opened& opened, Use use) {
    const auto& column = use.description.column;
    const auto found = opened.file.find(column);
    if (!found) {
      std::vector<std::string> names;
      for (const auto& title : opened.file.titles()) names.push_back(title.name);
      fail(use.description.place, ErrorCode::unknown_name,
           fmt::format("{}: there is no column '{}'. {}", opened.file.name(), column, suggest(column, names)));
    }
    const auto& model = *system_.instances[use.variable.instance].model;
    WantedSignal wanted{*found, &model, use.variable.variable};
    convert(opened, use, wanted);
    opened.wanted.push_back(wanted);
    opened.uses.push_back(std::move(use));
  }

  void convert(const Opened& opened, const Use& use, WantedSignal& wanted) {
    const auto& title = opened.file.titles()[wanted.column];
    const auto& written = use.description.unit;
    const auto place = fmt::format("{}: {}: '{}'", use.description.place, opened.file.name(), title.name);
    if (!title.unit.empty() && !written.empty() && written != title.unit) {
      fail(place, ErrorCode::wrong_unit,
           fmt::format("the unit in its title is [{}], but the config has [{}]", title.unit, written));
    }
    const auto& unit = title.unit.empty() ? written : title.unit;
    if (unit.empty()) return;
    const auto name = system_.text(use.variable);
    if (fmi::is_float(wanted.variable->type) && wanted.variable->unit.empty()) {
      system_.notices.push_back(
          fmt::format("{}: '{}' is in [{}], and '{}' has no unit, so it gets the numbers as they are",
                      opened.file.name(), title.name, unit, name));
      return;
    }
    const auto conversion = ColumnUnit(*wanted.model, *wanted.variable, unit, place).conversion();
    wanted.factor = conversion.factor;
    wanted.offset = conversion.offset;
    if (conversion.factor == 1 && conversion.offset == 0) return;
    system_.notices.push_back(fmt::format("{}: '{}' -> {}: converted from [{}] to [{}]", opened.file.name(), title.name,
                                          name, unit, wanted.variable->unit));
  }

  void finish(Opened& opened) {
    std::vector<std::shared_ptr<const Signal>> signals;
    try {
      signals = opened.file.read(opened.wanted);
    } catch (const InputError& error) {
      fail(opened.description.place, error.code(), error.what());
    }
    SignalCoverage coverage(system_, opened.file.name());
    for (std::size_t i = 0; i < signals.size(); ++i) {
      const auto& use = opened.uses[i];
      coverage.check(use.description, use.variable, *signals[i]);
      (use.entry ? system_.scenario_signals[*use.entry] : system_.inputs.at(use.variable).signal) = signals[i];
    }
    coverage.add_notices();
  }

  ResolvedSystem& system_;
  std::list<Opened> files_;  // a list, because its elements must not move in memory
};

}  // namespace

void resolve_signals(ResolvedSystem& system) {
  SignalReader(system).read();
}

}  // namespace mebots::master
