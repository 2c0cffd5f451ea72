// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "slave/discrete_link.hpp"
#include "slave/forwarding_slave.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// A slave for an instance that has clocks. Stores the values of clocked variables between ticks. An output keeps its
/// value of the last tick. A value that was set for an input is passed to the FMU at the next tick.
class HoldingSlave final : public ForwardingSlave {
 public:
  explicit HoldingSlave(std::unique_ptr<Slave> inner);

  void get_reals(std::span<const ValueReference> references, std::span<double> values) override;
  void get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) override;
  void get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) override;
  void get_strings(std::span<const ValueReference> references, std::span<std::string> values) override;
  void get_binaries(std::span<const ValueReference> references, std::span<std::string> values) override;
  void set_reals(std::span<const ValueReference> references, std::span<const double> values) override;
  void set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) override;
  void set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) override;
  void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) override;
  void set_binaries(std::span<const ValueReference> references, std::span<const std::string> values) override;

  std::unique_ptr<SlaveState> save_state() override;
  void restore_state(const SlaveState& state) override;
  std::vector<std::byte> serialize(const SlaveState& state) override;
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override;

  /// Returns the wrapped slave. Its clocked variables may be read and set only while their clocks tick.
  Slave& alone() { return inner(); }
  /// Sets the waiting inputs of a clock in the FMU. Must be called when the clock ticks.
  void give_inputs(ValueReference clock);
  /// Stores the values of a clock's outputs. Must be called when the clock ticks.
  void store_outputs(ValueReference clock);

  void visit(state::Visitor& v);

 private:
  /// Stores the value of a clocked variable between ticks.
  struct Held {
    const modeldesc::Variable* variable = nullptr;
    bool waits = false;  // true if the value must be set at the next tick
    LinkValue value;

    void visit(state::Visitor& v);
  };

  Held* held(ValueReference reference);
  template <typename T>
  void get(std::span<const ValueReference> references, std::span<T> values,
           void (Slave::*from_inner)(std::span<const ValueReference>, std::span<T>));
  template <typename T>
  void set(std::span<const ValueReference> references, std::span<const T> values,
           void (Slave::*to_inner)(std::span<const ValueReference>, std::span<const T>));

  std::map<ValueReference, Held> held_;
};

}  // namespace mebots::master
