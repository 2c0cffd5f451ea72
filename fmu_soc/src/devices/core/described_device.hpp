// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// Models a device that the board file describes completely: registers with their variables, opcodes, and states with
/// current, delay and next state.
///
/// A store of an opcode enters the opcode's state. The device refuses any other value. During a delay, it also refuses
/// opcodes of states with a delay. At the end of a delay, registers that show an input take its present value, the
/// ready bit is set, the interrupt line is raised, and the next state begins.
///
/// A register that shows "status" has three bits. Bit 0 is busy (during a delay). Bit 1 is ready; writing 1 clears this
/// bit and the interrupt. Bit 2 is refused; writing 1 clears this bit.
///
/// A register that shows a parameter always has the parameter's present value. If the device has no delays, the same
/// applies to inputs. A register that shows no variable keeps the last stored value; after reset, it has the value
/// `reset`. If the device has a `span`, loads from offsets without a register return 0, and the first access to each of
/// these offsets is reported.
///
/// If no register commits, a stored value becomes an output at once. Otherwise, all stored values become outputs at a
/// store into a register that commits. If a value exceeds the limits of its register, or is not in its variable's
/// enumeration, the device reports the value and sends nothing.
class DescribedDevice final : public Device {
 public:
  static constexpr std::uint32_t kBusy = 1;
  static constexpr std::uint32_t kReady = 2;
  static constexpr std::uint32_t kRefused = 4;

  DescribedDevice(const BoardDevice& entry, DeviceHost& host);

  double* input(std::string_view variable) override;
  /// Returns the value that a register sends to a variable: before the first store, the variable's start value.
  const double* output(std::string_view variable) const override;
  double energy_j(Picoseconds now) const override;

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return done_at_; }
  bool interrupt() const override { return (status_ & kReady) != 0; }
  std::string_view state_name() const override;
  /// Reports each parameter that a register shows and the program has never read, if it differs from its start value.
  void program_ended() override;
  void visit(state::Visitor& v) override;

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  struct Register {
    std::size_t input = kNone;   // index of the variable that a load returns
    std::size_t output = kNone;  // index of the variable that a store sets
    bool is_live = false;  // a load returns the present value of the input, not the value at the end of the last delay
    bool takes_opcodes = false;
    const BoardEnumeration* items = nullptr;  // enumeration of the values that a store may send; null = no enumeration
  };

  std::size_t register_at(std::uint32_t offset) const;
  std::size_t state_index(std::string_view name) const;
  void enter(std::size_t state, Picoseconds now);
  void obey(std::size_t reg, std::uint32_t value, Picoseconds now);
  void measure();
  /// Returns the reason why the register's value cannot be sent, or an empty text if it can be sent.
  std::string fault_of(std::size_t reg) const;
  bool pass_over(std::uint32_t offset, std::string_view access);
  void send(std::size_t first, std::size_t last, Picoseconds now);

  const BoardDevice& entry_;
  DeviceHost& host_;
  std::vector<std::uint32_t> warned_;  // offsets without a register that were reported; not part of a state
  std::vector<Register> registers_;    // in the order of the board entry
  bool commits_ = false;               // at least one register commits
  std::vector<double> inputs_;         // values of inputs and parameters, in the order of the board entry
  std::vector<double> outputs_;        // values of outputs, in the order of the board entry
  std::vector<std::uint32_t> values_;  // words of the registers, in the order of registers_
  /// Elements are 1 if the program has read the register, otherwise 0. In the order of registers_.
  std::vector<std::uint32_t> was_read_;
  std::vector<Picoseconds> spent_;  // time spent in each state, up to the last change of state
  std::uint64_t state_ = 0;
  std::uint32_t status_ = 0;
  Picoseconds since_ = 0;
  Picoseconds done_at_ = kNever;
};

}  // namespace mebots::soc
