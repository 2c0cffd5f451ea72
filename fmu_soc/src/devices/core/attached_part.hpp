// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/device_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// Models a part of the board that has no address. Its energy depends on the time in each of its states, and on the
/// number of transferred bytes:
///
/// energy = supply_voltage (sum over states of current x time + charge_per_byte x bytes)
///
/// The device that uses the part changes the part's state and counts the bytes (PartPort). Without such a device, the
/// part stays in its initial state. The energy is computed from integers, so that reading it more often does not change
/// it.
class AttachedPart final : public Device {
 public:
  explicit AttachedPart(const BoardDevice& entry);

  /// Returns the index of the state with this name. Throws Error if the entry has no such state.
  std::size_t state(std::string_view name) const;
  bool has_states() const { return !spent_.empty(); }
  void enter(std::size_t state, Picoseconds now);
  void pass(std::uint64_t bytes) { bytes_ += bytes; }

  bool load(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t& /*value*/) override { return false; }
  bool store(std::uint32_t /*offset*/, Picoseconds /*now*/, std::uint32_t /*value*/) override { return false; }
  double energy_j(Picoseconds now) const override;
  std::string_view state_name() const override;
  void visit(state::Visitor& v) override;

 private:
  const BoardDevice& entry_;
  std::vector<Picoseconds> spent_;  // time spent in each state, up to the last change of state
  std::uint64_t state_ = 0;
  Picoseconds since_ = 0;
  std::uint64_t bytes_ = 0;
};

/// Connects a device to a part of the board. The part is active while the device uses it, and otherwise idle. If no
/// part is attached, all calls have no effect.
class PartPort {
 public:
  PartPort() = default;
  /// `part` is null if no part is attached. Throws Error if a part with states lacks the state `idle` or `active`.
  explicit PartPort(AttachedPart* part);

  void begin(Picoseconds now) {
    if (part_ != nullptr && part_->has_states()) part_->enter(active_, now);
  }
  void end(Picoseconds now, std::uint64_t bytes = 0) {
    if (part_ == nullptr) return;
    part_->pass(bytes);
    if (part_->has_states()) part_->enter(idle_, now);
  }

 private:
  AttachedPart* part_ = nullptr;
  std::size_t idle_ = 0;
  std::size_t active_ = 0;
};

}  // namespace mebots::soc
