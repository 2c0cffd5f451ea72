// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/continuous/known_values.hpp"
#include "slave/discrete_link.hpp"
#include "slave/forwarding_slave.hpp"
#include "solver/continuous_instance.hpp"

#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

class ContinuousGroup;

/// A slave for a model exchange instance. Its step advances the whole continuous system. Setting an input to its
/// current value does not affect the solver.
class ContinuousSlave final : public ForwardingSlave {
 public:
  /// `instance` must be the same object as `inner` or, if `inner` is a HoldingSlave, the object that it wraps.
  ContinuousSlave(std::unique_ptr<Slave> inner, ContinuousInstance& instance, std::shared_ptr<ContinuousGroup> group);

  void setup_experiment(const Experiment& experiment) override;
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;

  std::uint32_t output_derivative_order() const override { return 0; }
  bool takes_input_derivatives() const override { return true; }
  void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                             std::span<const double> values) override;

  void set_reals(std::span<const ValueReference> references, std::span<const double> values) override;
  void set_integers(std::span<const ValueReference> references, std::span<const WholeNumber> values) override;
  void set_booleans(std::span<const ValueReference> references, std::span<const WholeNumber> values) override;
  void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) override;
  void set_binaries(std::span<const ValueReference> references, std::span<const std::string> values) override;

  std::unique_ptr<SlaveState> save_state() override;
  void restore_state(const SlaveState& state) override;
  std::vector<std::byte> serialize(const SlaveState& state) override;
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override;

  ContinuousInstance& instance() { return *instance_; }
  /// Returns the index of the slave among the members of its continuous system.
  std::size_t index() const { return member_; }
  /// Returns the wrapped slave. Calls to it do not affect the group.
  Slave& alone() { return inner(); }
  /// Extrapolates the inputs that have derivatives to `since_s` seconds after the last communication point, and sets
  /// them.
  Evaluation set_courses(double since_s);
  bool has_courses() const { return !courses_.empty(); }

  /// Sets an input to a value from a connection within the group. The instance must be in event mode. Returns true if
  /// the value has changed.
  bool set_in_event(ValueKind kind, ValueReference reference, const LinkValue& value);

  void visit(state::Visitor& v);

 private:
  /// A continuous input that has time derivatives.
  struct Course {
    ValueReference reference = 0;
    double value = 0;
    std::vector<double> derivatives;  // of order 1 and higher

    void visit(state::Visitor& v);
  };

  template <typename T>
  void set_discrete(KnownValues<T>& known, std::span<const ValueReference> references, std::span<const T> values,
                    void (Slave::*set)(std::span<const ValueReference>, std::span<const T>));
  void drop_course(ValueReference reference);

  ContinuousInstance* instance_;
  std::shared_ptr<ContinuousGroup> group_;
  std::size_t member_;
  std::set<ValueReference> continuous_inputs_;
  std::set<ValueReference> clocked_;  // changes of these variables take effect at the next tick of their clocks
  KnownValues<double> reals_;
  KnownValues<WholeNumber> integers_;
  KnownValues<WholeNumber> booleans_;
  KnownValues<std::string> strings_;  // also contains Binaries
  std::vector<Course> courses_;
};

}  // namespace mebots::master
