// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/override_schedule.hpp"
#include "slave/access_slave.hpp"

#include <optional>
#include <unordered_map>
#include <variant>

namespace mebots::master {

/// Applies the overrides of a scenario to variables of the wrapped slave. An override of an input changes the value
/// that the wrapped slave receives. An override of an output changes the value that other slaves receive. Overrides
/// take effect at the communication points of this slave.
class OverriddenSlave final : public AccessSlave {
 public:
  /// `schedule` must outlive the slave. `step_ns` is the length of the slave's steps.
  OverriddenSlave(std::unique_ptr<Slave> inner, const OverrideSchedule& schedule, std::size_t instance,
                  std::int64_t step_ns);

  void enter_initialization() override;
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;
  /// Gets derivatives of outputs with overrides: 0 for a constant value, the slope for a ramp.
  void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                              std::span<double> values) override;
  void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                             std::span<const double> values) override;

  std::unique_ptr<SlaveState> save_state() override;
  void restore_state(const SlaveState& state) override;
  std::vector<std::byte> serialize(const SlaveState& state) override;
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override;

  /// Visits the state of the overrides, without the state of the wrapped slave.
  void visit(state::Visitor& v);

 private:
  void get(ValueKind kind, std::span<const ValueReference> references, Destination values) override;
  void set(ValueKind kind, std::span<const ValueReference> references, Source values) override;

  using Value = std::variant<double, std::int64_t, std::string>;

  /// An override, and the original value of its variable at the start of the override.
  struct Layer {
    std::size_t override = 0;
    std::uint64_t noise_key = 0;
    std::size_t row = 0;                      // row of a signal at which the next search starts; not part of the state
    std::optional<std::int64_t> found_at_ns;  // start of the override; nullopt if it is not active
    Value found;

    void visit(state::Visitor& v) {
      v("found_at_ns", found_at_ns);
      v("found", found);
    }
  };
  /// A variable and its overrides in their order in the scenario.
  struct Target {
    ValueReference reference = 0;
    ValueKind kind = ValueKind::real;
    bool input = false;
    std::vector<Layer> layers;
    Value base;           // value of the input without overrides
    bool fresh = false;   // true if a value was set since the last step
    bool sloped = false;  // true if a signal provides the derivative; not part of the state
    // True if the connected output also provides derivatives. set_input_derivatives() then passes the slope of the
    // signal together with them. Not part of the state.
    bool connected = false;
    bool acted = false;  // true if the value in the wrapped slave differs from `base`

    void visit(state::Visitor& v) {
      v("base", base);
      v("fresh", fresh);
      v("acted", acted);
      v("layers", std::span(layers));
    }
  };

  /// Values of unconnected inputs of one type, which are set by one call.
  template <typename T>
  struct Batch {
    std::vector<ValueReference> references;
    std::vector<T> values;

    void clear() {
      references.clear();
      values.clear();
    }
  };

  Value apply(Target& target, const Value& value);
  Value apply(Layer& layer, const Value& value, std::int64_t since_ns);
  void set_free_inputs();
  void set_slopes();
  template <typename T>
  void pass_batch(ValueKind kind, Batch<T>& batch);
  template <typename T>
  void change_outputs(ValueKind kind, std::span<const ValueReference> references, std::span<T> values);
  template <typename T>
  bool change_inputs(ValueKind kind, std::span<const ValueReference> references, std::vector<T>& values);
  /// Returns the variable with this value reference; null if the scenario does not change it.
  Target* find(bool input, ValueKind kind, ValueReference reference);
  double changed_derivative(bool input, ValueReference reference, std::int32_t order, double value);
  double changed_derivative(Target& target, std::int32_t order, double value);
  double apply(Layer& layer, std::int32_t order, double derivative, std::int64_t since_ns);

  SignalTime signal_time(std::int64_t time_ns) const;

  const OverrideSchedule* schedule_;
  std::vector<Target> targets_;
  std::unordered_map<std::uint64_t, std::size_t> places_;  // key: kind and value reference; value: index in targets_
  std::int64_t time_ns_;
  std::int64_t step_ns_;
  bool initialising_ = true;
  Batch<double> reals_;
  Batch<std::int64_t> integers_;
  Batch<std::int64_t> booleans_;
  Batch<std::string> strings_;
  Batch<std::string> binaries_;
};

}  // namespace mebots::master
