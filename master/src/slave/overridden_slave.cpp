// SPDX-License-Identifier: Apache-2.0
#include "slave/overridden_slave.hpp"

#include "base/time.hpp"
#include "mebots/assert.hpp"
#include "mebots/state/save.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mebots::master {
namespace {

/// Mixes bits with the finaliser of SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// Converts random bits to a number in the open interval (0, 1).
double uniform(std::uint64_t bits) {
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

/// Returns a normally distributed number with mean 0 and standard deviation 1 (Box and Muller, 1958). It depends only
/// on the arguments, not on earlier calls.
double gaussian(std::uint64_t key, std::int64_t time_ns) {
  const auto first = mixed(key ^ mixed(static_cast<std::uint64_t>(time_ns)));
  const auto second = mixed(first);
  return std::sqrt(-2 * std::log(uniform(first))) * std::cos(2 * std::numbers::pi * uniform(second));
}

/// Combines the seed with the name of the variable, so that variables with the same seed have different noise.
std::uint64_t noise_key(const OverrideDescription& description) {
  auto key = mixed(description.seed);
  for (const char c : description.variable.text()) key = mixed(key ^ static_cast<unsigned char>(c));
  return key;
}

class OverriddenState final : public SlaveState {
 public:
  std::unique_ptr<SlaveState> inner;
  std::vector<std::byte> own;
};

std::variant<double, std::int64_t, std::string> plain(const modeldesc::Value& value, ValueKind kind) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* number = std::get_if<std::int64_t>(&value)) return *number;
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? 1 : 0;
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (kind == ValueKind::real) return 0.0;
  if (kind == ValueKind::string || kind == ValueKind::binary) return std::string();
  return std::int64_t{0};
}

std::uint64_t place_key(ValueKind kind, ValueReference reference) {
  constexpr unsigned kReferenceBits = 32;
  return static_cast<std::uint64_t>(kind) << kReferenceBits | reference;
}

}  // namespace

OverriddenSlave::OverriddenSlave(std::unique_ptr<Slave> inner, const OverrideSchedule& schedule, std::size_t instance,
                                 std::int64_t step_ns)
    : AccessSlave(std::move(inner)), schedule_(&schedule), time_ns_(schedule.start_ns()), step_ns_(step_ns) {
  const auto& overrides = schedule.overrides();
  for (std::size_t i = 0; i < overrides.size(); ++i) {
    if (overrides[i].variable.instance != instance) continue;
    const auto& variable = *overrides[i].variable.variable;
    const auto kind = kind_of(variable.type);
    const auto [place, is_new] = places_.emplace(place_key(kind, variable.value_reference), targets_.size());
    if (is_new) {
      Target added;
      added.reference = variable.value_reference;
      added.kind = kind;
      // Also true for a tunable parameter, which is set like an input.
      added.input = variable.causality != modeldesc::Causality::output;
      added.base = plain(variable.start, kind);
      targets_.push_back(std::move(added));
    }
    auto& target = targets_[place->second];
    target.sloped |= overrides[i].signal != nullptr && overrides[i].signal->linear() && target.input;
    target.layers.push_back({i, noise_key(*overrides[i].description), 0, {}, {}});
  }
}

SignalTime OverriddenSlave::signal_time(std::int64_t time_ns) const {
  return {time_ns, schedule_->grid().time_s(time_ns)};
}

OverriddenSlave::Value OverriddenSlave::apply(Layer& layer, const Value& value, std::int64_t since_ns) {
  const auto& override = schedule_->overrides()[layer.override];
  const auto& description = *override.description;
  switch (description.action) {
    case OverrideAction::set:
      return plain(*override.value, ValueKind::real);
    case OverrideAction::freeze:
      return layer.found;
    case OverrideAction::signal:
      // At a jump at the start, initialization uses the value before the jump, and the first step uses the value after
      // it, as in FMPy.
      return override.signal->at(signal_time(time_ns_), initialising_ ? SignalSide::before : SignalSide::after,
                                 layer.row);
    case OverrideAction::offset:
      return std::get<double>(value) + description.number;
    case OverrideAction::scale:
      return std::get<double>(value) * description.number;
    case OverrideAction::noise:
      return std::get<double>(value) + description.number * gaussian(layer.noise_key, time_ns_);
    case OverrideAction::ramp:
      break;
  }
  if (schedule_->grid().has_passed(since_ns, time_ns_, description.over_ns)) return description.number;
  const double part = static_cast<double>(time_ns_ - since_ns) / static_cast<double>(description.over_ns);
  const double found = std::get<double>(layer.found);
  return found + part * (description.number - found);
}

OverriddenSlave::Value OverriddenSlave::apply(Target& target, const Value& value) {
  Value result = value;
  target.acted = false;
  for (auto& layer : target.layers) {
    const auto since_ns = schedule_->since(layer.override, time_ns_);
    if (!since_ns) {
      layer.found_at_ns.reset();
      continue;
    }
    target.acted = true;
    // When the override starts, stores the value that the variable would have without it. If several values are set at
    // this communication point, stores the last one.
    if (!layer.found_at_ns || layer.found_at_ns == time_ns_) {
      layer.found_at_ns = time_ns_;
      layer.found = result;
    }
    result = apply(layer, result, *since_ns);
  }
  return result;
}

template <typename T>
void OverriddenSlave::change_outputs(ValueKind kind, std::span<const ValueReference> references, std::span<T> values) {
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (auto* target = find(false, kind, references[i])) values[i] = std::get<T>(apply(*target, values[i]));
  }
}

template <typename T>
bool OverriddenSlave::change_inputs(ValueKind kind, std::span<const ValueReference> references,
                                    std::vector<T>& values) {
  bool changed = false;
  for (std::size_t i = 0; i < references.size(); ++i) {
    auto* target = find(true, kind, references[i]);
    if (target == nullptr) continue;
    target->base = values[i];
    target->fresh = true;
    values[i] = std::get<T>(apply(*target, values[i]));
    changed = true;
  }
  return changed;
}

OverriddenSlave::Target* OverriddenSlave::find(bool input, ValueKind kind, ValueReference reference) {
  const auto found = places_.find(place_key(kind, reference));
  if (found == places_.end()) return nullptr;
  auto& target = targets_[found->second];
  return target.input == input ? &target : nullptr;
}

void OverriddenSlave::enter_initialization() {
  inner().enter_initialization();
  set_free_inputs();
}

void OverriddenSlave::exit_initialization() {
  inner().exit_initialization();
  initialising_ = false;
}

template <typename T>
void OverriddenSlave::pass_batch(ValueKind kind, Batch<T>& batch) {
  if (!batch.references.empty()) pass_set(kind, batch.references, std::span<const T>(batch.values));
  batch.clear();
}

/// Sets the inputs that no connection has set since the last step. Their only source is the scenario.
void OverriddenSlave::set_free_inputs() {
  const auto put = [](auto& batch, const Target& target, auto value) {
    batch.references.push_back(target.reference);
    batch.values.push_back(std::move(value));
  };
  for (auto& target : targets_) {
    if (!target.input) continue;
    if (!target.fresh) {
      const bool acted = target.acted;
      auto value = apply(target, target.base);
      if (!target.acted && !acted) continue;
      if (target.kind == ValueKind::real) put(reals_, target, std::get<double>(value));
      if (target.kind == ValueKind::integer) put(integers_, target, std::get<std::int64_t>(value));
      if (target.kind == ValueKind::boolean) put(booleans_, target, std::get<std::int64_t>(value));
      if (target.kind == ValueKind::string || target.kind == ValueKind::binary) {
        put(target.kind == ValueKind::string ? strings_ : binaries_, target, std::get<std::string>(std::move(value)));
      }
    }
    target.fresh = false;
  }
  pass_batch(ValueKind::real, reals_);
  pass_batch(ValueKind::integer, integers_);
  pass_batch(ValueKind::boolean, booleans_);
  pass_batch(ValueKind::string, strings_);
  pass_batch(ValueKind::binary, binaries_);
}

/// If an input follows a signal file and the FMU uses derivatives of its inputs, passes the slope of the signal as a
/// derivative. A slope of 0 replaces an earlier slope.
void OverriddenSlave::set_slopes() {
  if (!inner().takes_input_derivatives()) return;
  std::vector<std::int32_t> orders;
  for (auto& target : targets_) {
    if (!target.sloped || target.connected) continue;
    reals_.references.push_back(target.reference);
    reals_.values.push_back(changed_derivative(target, 1, 0));
    orders.push_back(1);
  }
  if (!orders.empty()) inner().set_input_derivatives(reals_.references, orders, reals_.values);
  reals_.clear();
}

StepResult OverriddenSlave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  time_ns_ = start_ns;
  step_ns_ = duration_ns;
  set_free_inputs();
  set_slopes();
  auto result = inner().step(start_ns, duration_ns);
  time_ns_ = start_ns + duration_ns;
  return result;
}

/// Returns the time derivative of a variable after one override. `derivative` is the derivative without this override.
/// Both have the order `order` (1 or higher).
double OverriddenSlave::apply(Layer& layer, std::int32_t order, double derivative, std::int64_t since_ns) {
  const auto& override = schedule_->overrides()[layer.override];
  const auto& description = *override.description;
  switch (description.action) {
    case OverrideAction::set:
    case OverrideAction::freeze:
      return 0;
    case OverrideAction::signal:
      if (order > 1) return 0;
      return override.signal->slope(signal_time(time_ns_), signal_time(time_ns_ + step_ns_), layer.row);
    case OverrideAction::offset:
    case OverrideAction::noise:  // each point has a new random value
      return derivative;
    case OverrideAction::scale:
      return derivative * description.number;
    case OverrideAction::ramp:
      break;
  }
  if (order > 1 || schedule_->grid().has_passed(since_ns, time_ns_, description.over_ns)) return 0;
  return (description.number - std::get<double>(layer.found)) / to_seconds(description.over_ns);
}

double OverriddenSlave::changed_derivative(Target& target, std::int32_t order, double value) {
  for (auto& layer : target.layers) {
    const auto since_ns = schedule_->since(layer.override, time_ns_);
    if (since_ns) value = apply(layer, order, value, *since_ns);
  }
  return value;
}

double OverriddenSlave::changed_derivative(bool input, ValueReference reference, std::int32_t order, double value) {
  auto* target = find(input, ValueKind::real, reference);
  if (target == nullptr) return value;
  target->connected = true;
  return changed_derivative(*target, order, value);
}

void OverriddenSlave::get_output_derivatives(std::span<const ValueReference> references,
                                             std::span<const std::int32_t> orders, std::span<double> values) {
  inner().get_output_derivatives(references, orders, values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = changed_derivative(false, references[i], orders[i], values[i]);
  }
}

void OverriddenSlave::set_input_derivatives(std::span<const ValueReference> references,
                                            std::span<const std::int32_t> orders, std::span<const double> values) {
  std::vector<double> changed(values.begin(), values.end());
  for (std::size_t i = 0; i < changed.size(); ++i) {
    changed[i] = changed_derivative(true, references[i], orders[i], changed[i]);
  }
  inner().set_input_derivatives(references, orders, changed);
}

void OverriddenSlave::get(ValueKind kind, std::span<const ValueReference> references, Destination destination) {
  pass_get(kind, references, destination);
  std::visit([&](auto values) { change_outputs(kind, references, values); }, destination);
}

void OverriddenSlave::set(ValueKind kind, std::span<const ValueReference> references, Source source) {
  std::visit(
      [&]<typename T>(std::span<const T> values) {
        std::vector<T> changed(values.begin(), values.end());
        const bool any = change_inputs(kind, references, changed);
        pass_set(kind, references, any ? std::span<const T>(changed) : values);
      },
      source);
}

void OverriddenSlave::visit(state::Visitor& v) {
  v("time_ns", time_ns_);
  v("initialising", initialising_);
  v("targets", std::span(targets_));
}

std::unique_ptr<SlaveState> OverriddenSlave::save_state() {
  auto state = std::make_unique<OverriddenState>();
  state->inner = inner().save_state();
  state->own = state::save(*this);
  return state;
}

void OverriddenSlave::restore_state(const SlaveState& state) {
  const auto& overridden = static_cast<const OverriddenState&>(state);
  inner().restore_state(*overridden.inner);
  state::restore(*this, overridden.own);
}

std::vector<std::byte> OverriddenSlave::serialize(const SlaveState& state) {
  const auto& overridden = static_cast<const OverriddenState&>(state);
  state::Writer writer;
  writer.put(overridden.own);
  writer.put(inner().serialize(*overridden.inner));
  return writer.take();
}

std::unique_ptr<SlaveState> OverriddenSlave::deserialize(std::span<const std::byte> bytes) {
  state::Reader reader(bytes);
  auto state = std::make_unique<OverriddenState>();
  reader.get(state->own);
  std::vector<std::byte> content;
  reader.get(content);
  state->inner = inner().deserialize(content);
  return state;
}

}  // namespace mebots::master
