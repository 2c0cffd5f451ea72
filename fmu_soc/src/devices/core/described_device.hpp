// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// A device without C++ code. The board file describes what its registers show and send, the values that are opcodes,
/// and the states: current, delay and next state of each.
///
///   opcode stored    The device enters the opcode's state. A value that is not an opcode is refused; so is a state
///   with
///                    a delay while a delay runs.
///   after the delay  Registers that show an input take its present value. Ready is set, the interrupt line goes up,
///   and
///                    the next state begins.
///
/// A register that shows "status" has bit 0 busy (a delay runs), bit 1 ready (write 1 to clear, which also clears the
/// interrupt) and bit 2 refused (write 1 to clear). Parameters are shown directly, and so are inputs if the device has
/// no delays. Registers that show no variable keep their last stored value; after reset it is `reset`. If the device
/// has a `span`, an access without a register is reported once; a load returns 0.
///
/// The value of a register that sends becomes an output at once, or at the next store into a register that commits. If
/// a value is outside the limits of its register or of its variable's enumeration, it is reported and nothing is sent.
class DescribedDevice final : public Device {
 public:
  static constexpr std::uint32_t kBusy = 1;
  static constexpr std::uint32_t kReady = 2;
  static constexpr std::uint32_t kRefused = 4;

  DescribedDevice(const BoardDevice& entry, DeviceHost& host);

  double* input(std::string_view variable) override;
  /// Returns the value that a register has sent; 0 before the first store.
  const double* output(std::string_view variable) const override;
  double energy_j(Picoseconds now) const override;

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return done_at_; }
  bool interrupt() const override { return (status_ & kReady) != 0; }
  std::string_view state_name() const override;
  /// Reports parameters that have another value than their start value, but that the program never read.
  void program_ended() override;
  void visit(state::Visitor& v) override;

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// Properties of a register from the entry, as indices.
  struct Register {
    std::size_t input = kNone;   // variable that it shows
    std::size_t output = kNone;  // variable that it sends
    bool is_live = false;        // shows the present value, not the one measured at the end of a delay
    bool takes_opcodes = false;
    const BoardEnumeration* items = nullptr;  // items of the enumeration that it sends
  };

  std::size_t register_at(std::uint32_t offset) const;
  std::size_t state_index(std::string_view name) const;
  void enter(std::size_t state, Picoseconds now);
  void obey(std::size_t reg, std::uint32_t value, Picoseconds now);
  void measure();
  /// Returns a text if the register's value cannot be sent; otherwise empty.
  std::string fault_of(std::size_t reg) const;
  bool pass_over(std::uint32_t offset, std::string_view access);
  void send(std::size_t first, std::size_t last, Picoseconds now);

  const BoardDevice& entry_;
  DeviceHost& host_;
  std::vector<std::uint32_t> warned_;    // offsets without a register that were reported; not part of a state
  std::vector<Register> registers_;      // in the order of the entry
  bool commits_ = false;                 // true if a register commits
  std::vector<double> inputs_;           // inputs and parameters, in the order of the entry
  std::vector<double> outputs_;          // outputs, in the order of the entry
  std::vector<std::uint32_t> values_;    // in the order of registers_
  std::vector<std::uint32_t> was_read_;  // likewise, 0 or 1
  std::vector<Picoseconds> spent_;       // in each state, up to the last change
  std::uint64_t state_ = 0;
  std::uint32_t status_ = 0;
  Picoseconds since_ = 0;
  Picoseconds done_at_ = kNever;
};

}  // namespace mebots::soc
