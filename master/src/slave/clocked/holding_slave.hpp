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

/// A slave that stores the values of clocked variables between ticks. A clocked output has the value of its last tick.
/// The value of a clocked input is passed to the FMU at the next tick.
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

  /// Returns the wrapped slave. Its clocked variables can be accessed only while their clocks tick.
  Slave& alone() { return inner(); }
  /// Passes the stored values of the inputs that belong to `clock` to the FMU. Must be called when the clock ticks.
  void give_inputs(ValueReference clock);
  /// Reads the outputs that belong to `clock` from the FMU and stores them. Must be called when the clock ticks.
  void store_outputs(ValueReference clock);

  void visit(state::Visitor& v);

 private:
  struct Held {
    const modeldesc::Variable* variable = nullptr;
    bool waits = false;  // true: the FMU receives the value at the next tick
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
