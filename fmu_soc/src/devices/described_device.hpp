// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/own_device.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// A device without code of its own: the board file says what its registers show, which stored values are opcodes,
/// which states there are, what each draws, how long it lasts and what follows.
///
///   opcode stored    the device goes into the opcode's state. Refused: a value that is no opcode, and a state with a
///                    delay while another one runs.
///   + delay          registers that show a variable take its value of now; ready is set, the interrupt line goes up;
///   the
///                    state that follows begins.
///
/// A register that shows "status" has bit 0 busy (a delay runs), bit 1 ready (write 1 to clear, which also clears the
/// interrupt) and bit 2 refused (write 1 to clear). Registers that show nothing keep what is stored into them; those
/// that send a variable put it out.
class DescribedDevice final : public OwnDevice {
 public:
  static constexpr std::uint32_t kBusy = 1;
  static constexpr std::uint32_t kReady = 2;
  static constexpr std::uint32_t kRefused = 4;

  explicit DescribedDevice(const BoardDevice& description);

  const BoardDevice& description() const override { return description_; }
  bool set_sensed(std::string_view variable, double value) override;
  /// As a register sends it, 0 before anything was stored.
  std::optional<double> sent(std::string_view variable) const override;
  double energy_j(Picoseconds now) const override;

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return done_at_; }
  bool interrupt() const override { return (status_ & kReady) != 0; }
  std::string_view state_name() const override { return description_.states[state_].name; }
  void visit(state::Visitor& v) override;

 private:
  void enter(std::size_t state, Picoseconds now);
  void obey(const BoardOpcode* opcode, Picoseconds now);
  void measure();
  std::size_t register_at(std::uint32_t offset) const;
  std::size_t state_index(std::string_view name) const;

  BoardDevice description_;
  std::vector<double> sensed_;         // as the description's variables
  std::vector<std::uint32_t> values_;  // as its registers
  std::vector<Picoseconds> spent_;     // in each state, up to the last change
  std::uint64_t state_ = 0;
  std::uint32_t status_ = 0;
  Picoseconds since_ = 0;
  Picoseconds done_at_ = kNever;
};

}  // namespace mebots::soc
