// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// A device without code of its own. The board file says what its registers show and send, and which stored values
/// are opcodes; which states there are, what each draws, how long it lasts and what follows.
///
///   opcode stored    the device goes into the opcode's state. Refused: a value that is not an opcode, and a state with
///   a
///                    delay while another one runs.
///   + delay          registers that show an input take its value of now; ready is set, the interrupt line goes up; the
///                    state that follows begins.
///
/// A register that shows "status" has bit 0 busy (a delay runs), bit 1 ready (write 1 to clear, which also clears the
/// interrupt) and bit 2 refused (write 1 to clear). Parameters, and inputs of a device without delays, are shown as
/// they are. Registers that show nothing keep what is stored into them, and hold
/// their `reset` before. In a device with a `span`, an access where no register stands is told once and passes: it
/// reads 0. What is stored into one that sends goes out, at once or, where another register commits, with the next
/// store into that. A value outside the limits of its register or of its variable's enumeration is told, and nothing
/// goes out.
class DescribedDevice final : public Device {
 public:
  static constexpr std::uint32_t kBusy = 1;
  static constexpr std::uint32_t kReady = 2;
  static constexpr std::uint32_t kRefused = 4;

  DescribedDevice(const BoardDevice& entry, DeviceHost& host);

  double* input(std::string_view variable) override;
  /// As a register sends it, 0 before anything was stored.
  const double* output(std::string_view variable) const override;
  double energy_j(Picoseconds now) const override;

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return done_at_; }
  bool interrupt() const override { return (status_ & kReady) != 0; }
  std::string_view state_name() const override;
  /// Reports parameters that differ from their start values, and that the program never read.
  void program_ended() override;
  void visit(state::Visitor& v) override;

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// What the entry says of a register, as indices.
  struct Register {
    std::size_t input = kNone;   // that it shows
    std::size_t output = kNone;  // that it sends
    bool is_live = false;        // shows what is, not what was measured
    bool takes_opcodes = false;
    const BoardEnumeration* items = nullptr;  // of the variable that it sends
  };

  std::size_t register_at(std::uint32_t offset) const;
  std::size_t state_index(std::string_view name) const;
  void enter(std::size_t state, Picoseconds now);
  void obey(std::size_t reg, std::uint32_t value, Picoseconds now);
  void measure();
  /// What is wrong with what the register holds; empty = nothing.
  std::string fault_of(std::size_t reg) const;
  bool pass_over(std::uint32_t offset, std::string_view access);
  void send(std::size_t first, std::size_t last, Picoseconds now);

  const BoardDevice& entry_;
  DeviceHost& host_;
  std::vector<std::uint32_t> warned_;    // offsets without register; not part of a state
  std::vector<Register> registers_;      // as the entry's
  bool commits_ = false;                 // some register does
  std::vector<double> inputs_;           // as the entry's variables, those that go in only
  std::vector<double> outputs_;          // likewise, those that go out
  std::vector<std::uint32_t> values_;    // as its registers
  std::vector<std::uint32_t> was_read_;  // likewise, 0 or 1
  std::vector<Picoseconds> spent_;       // in each state, up to the last change
  std::uint64_t state_ = 0;
  std::uint32_t status_ = 0;
  Picoseconds since_ = 0;
  Picoseconds done_at_ = kNever;
};

}  // namespace mebots::soc
