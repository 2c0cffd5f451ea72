// SPDX-License-Identifier: Apache-2.0
#include "run/mission.hpp"

#include "base/input_error.hpp"
#include "base/nearest_names.hpp"
#include "base/time.hpp"
#include "observer/scenario.hpp"
#include "system/record_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variability;

class Listener final : public MessageSink {
 public:
  explicit Listener(const std::function<void(const Message&)>& listener) : listener_(&listener) {}
  void message(const Message& message) override {
    if (*listener_) (*listener_)(message);
  }

 private:
  const std::function<void(const Message&)>* listener_;
};

/// Keeps what the config records.
class MemoryRecorder final : public Observer {
 public:
  MemoryRecorder(const ResolvedSystem& system, Ensemble& ensemble) : ensemble_(&ensemble) {
    const auto& description = *system.description;
    if (description.record.interval_ns > 0) every_steps_ = description.record.interval_ns / description.step_ns;
    for (const auto& variable : recorded_variables(system)) {
      if (variable.variable->type == Type::string) continue;
      signals_.push_back(ensemble.watch(variable));
      series_.push_back({system.text(variable), variable.variable->unit, {}});
    }
  }

  std::optional<std::string> reached(const Point& point) override {
    if (point.step % every_steps_ == 0) keep(point);
    return std::nullopt;
  }
  void ended(const Point& point) override {
    if (last_step_ != point.step) keep(point);
  }

  const std::vector<double>& times() const { return times_; }
  const std::vector<Series>& series() const { return series_; }

 private:
  void keep(const Point& point) {
    times_.push_back(to_seconds(point.time_ns));
    for (std::size_t i = 0; i < signals_.size(); ++i) {
      const auto id = signals_[i];
      series_[i].values.push_back(id.kind == ValueKind::real ? ensemble_->real(id) : ensemble_->integer(id));
    }
    last_step_ = point.step;
  }

  const Ensemble* ensemble_;
  std::int64_t every_steps_ = 1;
  std::int64_t last_step_ = -1;
  std::vector<SignalId> signals_;
  std::vector<double> times_;
  std::vector<Series> series_;
};

VariableName split(std::string_view text) {
  const auto dot = text.find('.');
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == text.size())
    throw InputError(fmt::format("'{}' is no variable: write instance.variable", text));
  return {std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}

SlaveOptions changed_by(const Scenario& scenario) {
  SlaveOptions options;
  options.scenario = &scenario;
  return options;
}

}  // namespace

struct Mission::Running {
  Running(const SystemDescription& description, const std::function<void(const Message&)>& on_message)
      : listener(on_message),
        system(resolve(description, library)),
        scenario(system),
        simulation(system, listener, changed_by(scenario)),
        recorder(system, simulation.ensemble()),
        outcomes(system, simulation.ensemble()),
        stop_conditions(system, simulation.ensemble()) {
    scenario.watch(system, simulation.ensemble());
    for (Observer* observer : std::initializer_list<Observer*>{&scenario, &recorder, &outcomes, &stop_conditions})
      simulation.add(*observer);
    simulation.initialize();
  }

  Listener listener;
  FmuLibrary library;
  ResolvedSystem system;
  Scenario scenario;
  Simulation simulation;
  MemoryRecorder recorder;
  Outcomes outcomes;
  StopConditions stop_conditions;
  bool terminated = false;
};

Mission::Mission(const std::filesystem::path& config) : description_(read_config(config)) {}
Mission::~Mission() = default;

void Mission::require_not_started(const char* what) const {
  if (running_) throw InputError(fmt::format("{} comes too late: the mission stands at {} s", what, time_s()));
}

void Mission::on_message(std::function<void(const Message&)> listener) {
  require_not_started("on_message");
  listener_ = std::move(listener);
}

void Mission::set(std::string_view variable, WrittenValue value) {
  require_not_started("set");
  const auto name = split(variable);
  const auto found = std::ranges::find(description_.instances, name.instance, &InstanceDescription::name);
  if (found == description_.instances.end())
    throw InputError(fmt::format("'{}': there is no instance '{}'. {}", variable, name.instance,
                                 suggest(name.instance, description_.instance_names())));
  found->parameters.push_back({name.variable, std::move(value), fmt::format("set(\"{}\")", variable)});
}

void Mission::set_stop_time(double stop_time_s) {
  require_not_started("set_stop_time");
  const auto time_ns = to_nanoseconds(stop_time_s);
  if (!time_ns) throw InputError(fmt::format("stop time {} s is not a whole number of nanoseconds", stop_time_s));
  master::set_stop_time(description_, *time_ns, "set_stop_time");
}

void Mission::record(const std::vector<std::string>& patterns) {
  require_not_started("record");
  description_.record.patterns.emplace();
  for (const auto& pattern : patterns) description_.record.patterns->push_back({pattern, "record"});
}

void Mission::start() {
  if (!running_) running_ = std::make_unique<Running>(description_, listener_);
}

bool Mission::step() {
  start();
  const bool stepped = running_->simulation.step();
  if (running_->simulation.ended() && !running_->terminated) {
    running_->terminated = true;
    running_->simulation.terminate();
  }
  return stepped;
}

void Mission::run() {
  while (step()) {
  }
}

void Mission::run_until(double time_s) {
  const auto until_ns = to_nanoseconds(time_s);
  if (!until_ns) throw InputError(fmt::format("the time {} s is not a whole number of nanoseconds", time_s));
  start();
  while (running_->simulation.time_ns() < *until_ns && step()) {
  }
}

double Mission::time_s() const {
  return running_ ? to_seconds(running_->simulation.time_ns()) : 0;
}
double Mission::step_s() const {
  return to_seconds(description_.step_ns);
}
double Mission::stop_time_s() const {
  return to_seconds(description_.stop_time_ns);
}
bool Mission::ended() const {
  return running_ && running_->simulation.ended();
}
std::string Mission::outcome() const {
  return running_ ? running_->outcomes.outcome() : "";
}
std::string Mission::end_text() const {
  return ended() ? running_->simulation.end().text : "";
}

ResolvedVariable Mission::find(std::string_view variable) const {
  return running_->system.find(split(variable), fmt::format("'{}'", variable));
}

double Mission::value(std::string_view variable) {
  start();
  const auto [instance, found] = find(variable);
  auto& slave = running_->simulation.ensemble().slave(instance);
  const ValueReference reference[] = {found->value_reference};
  switch (kind_of(found->type)) {
    case ValueKind::real: {
      double value[1] = {};
      slave.get_reals(reference, value);
      return value[0];
    }
    case ValueKind::integer: {
      std::int32_t value[1] = {};
      slave.get_integers(reference, value);
      return value[0];
    }
    case ValueKind::boolean: {
      std::int32_t value[1] = {};
      slave.get_booleans(reference, value);
      return value[0] == 0 ? 0 : 1;
    }
    case ValueKind::string:
      break;
  }
  throw InputError(fmt::format("'{}' is a String: ask for its text", variable));
}

std::string Mission::text(std::string_view variable) {
  start();
  const auto [instance, found] = find(variable);
  if (found->type != Type::string) throw InputError(fmt::format("'{}' is no String: ask for its value", variable));
  const ValueReference reference[] = {found->value_reference};
  std::string value[1];
  running_->simulation.ensemble().slave(instance).get_strings(reference, value);
  return value[0];
}

void Mission::write(std::string_view variable, double value) {
  start();
  const auto target = find(variable);
  const bool settable =
      target.variable->causality == Causality::input ||
      (target.variable->causality == Causality::parameter && target.variable->variability == Variability::tunable);
  if (!settable)
    throw InputError(fmt::format("'{}' is {} of variability {}: only inputs and tunable parameters can be set in a run",
                                 variable, to_string(target.variable->causality),
                                 to_string(target.variable->variability)));
  for (const auto& connection : running_->system.connections)
    if (connection.to == target)
      throw InputError(fmt::format("'{}' is connected to '{}', which would overwrite the value", variable,
                                   running_->system.text(connection.from)));
  // The same rules as for values of a config: type, limits, items.
  const auto& model = running_->system.instances[target.instance].fmu->description();
  const auto place = fmt::format("write(\"{}\")", variable);
  const bool whole = target.variable->type == Type::integer || target.variable->type == Type::enumeration;
  WrittenValue written = value;
  if (whole && value == std::floor(value) && std::abs(value) < 1e15) written = static_cast<std::int64_t>(value);
  if (target.variable->type == Type::boolean && (value == 0 || value == 1)) written = value != 0;
  const auto typed = typed_value(model, *target.variable, written, place);
  auto& slave = running_->simulation.ensemble().slave(target.instance);
  const ValueReference reference[] = {target.variable->value_reference};
  if (const auto* real = std::get_if<double>(&typed)) slave.set_reals(reference, {real, 1});
  if (const auto* integer = std::get_if<std::int32_t>(&typed)) slave.set_integers(reference, {integer, 1});
  if (const auto* boolean = std::get_if<bool>(&typed)) {
    const std::int32_t flag = *boolean ? 1 : 0;
    slave.set_booleans(reference, {&flag, 1});
  }
}

std::span<const double> Mission::times() const {
  if (!running_) return {};
  return running_->recorder.times();
}
std::span<const Series> Mission::series() const {
  if (!running_) return {};
  return running_->recorder.series();
}

}  // namespace mebots::master
