// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "cluster/cluster.hpp"
#include "devices/core/kinds.hpp"
#include "devices/gap8/event_unit.hpp"
#include "devices/gap8/signals.hpp"
#include "devices/generic/power_manager.hpp"
#include "mebots/soc/device.hpp"
#include "mebots/state/visitor.hpp"
#include "runs/hart.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// The devices of a chip and the parts of its board, without the devices that the cluster creates.
class DeviceSet {
 public:
  struct Member {
    const BoardDevice* entry = nullptr;
    Device* device = nullptr;
  };
  struct Slot {
    std::string name;
    std::uint32_t base = 0;
    std::uint32_t size = 0;  // bytes
    int interrupt = -1;
    InterruptController* controller = nullptr;  // controller that receives the interrupt; null = the core itself
    Device* device = nullptr;
    bool sets_power = false;  // true if the device sets clocks, voltage or the power of the cluster
  };
  struct State {
    std::string_view name;
    std::string_view state;
  };

  DeviceSet(const BoardDescription& board, std::span<const std::filesystem::path> library_folders);
  DeviceSet(const DeviceSet&) = delete;
  DeviceSet& operator=(const DeviceSet&) = delete;

  /// Creates all devices. Throws Error if the devices of the board are not compatible with each other.
  void make(ChipHost& host);

  /// Iterate over the parts of the board and then the devices, each in the order of the board file.
  auto begin() const { return members_.begin(); }
  auto end() const { return members_.end(); }
  /// Returns the device with this name, or null if the board has no such device.
  Device* find(std::string_view name) const;
  /// Return the storage of a variable, or null if no device has this variable. See mebots/soc/device.hpp.
  double* input(std::string_view variable) const;
  const double* output(std::string_view variable) const;
  /// Returns the present state of each device that has several states.
  std::vector<State> states() const;
  /// Returns true while a picture that the program has requested is not in memory yet.
  bool wait_for_picture() const;
  std::vector<Device*> made() const;

  const Slot* slot_at(std::uint32_t address) const {
    for (const auto& slot : slots_) {
      if (address >= slot.base && address - slot.base < slot.size) return &slot;
    }
    return nullptr;
  }
  PowerManager* power_manager() const { return power_manager_; }
  /// Returns the fabric controller's event unit of GAP8, or null if the board has none.
  gap8_devices::EventUnit* event_unit() const { return event_unit_; }
  gap8_devices::Signals& signals() { return signals_; }
  const gap8_devices::Signals& signals() const { return signals_; }

  /// Discards cached data about the devices. Must be called at every access, at every event, and at every change by a
  /// caller outside the chip.
  void touch() { cached_ = {}; }
  void begin_step(Picoseconds now) const;
  void end_program();
  Picoseconds next_event();
  void forget_next_event() { cached_.next_event = false; }
  void advance(Picoseconds time);
  /// Sets the interrupt lines of the fabric controller to the levels of the devices and of the cluster.
  void update_lines(Hart& hart, const Cluster* cluster, int cluster_interrupt);
  void acknowledge(unsigned line, Hart& hart);

  /// Returns the clocks, the voltage and the cluster's power that the firmware has requested, or null if no device sets
  /// them.
  const PowerSettings* power_settings() const;
  bool power_is_applied() const { return cached_.power; }
  void set_power_applied() { cached_.power = true; }
  bool have_exited() const { return signals_.exit_code || (power_manager_ != nullptr && power_manager_->exited()); }
  std::int32_t exit_code() const;

  void visit(state::Visitor& v);

 private:
  /// Flags for data about the devices that are still valid. touch() clears them. Not part of a saved state.
  struct Cached {
    bool next_event = false;
    bool lines = false;
    bool power = false;
  };

  void add_parts(ChipHost& host);
  void add_on_bus(ChipHost& host);
  void connect_interrupts();
  void note_roles(const BoardDevice& entry, Device& device);
  void check_attachments(const ChipHost& host) const;

  const BoardDescription& board_;
  Kinds kinds_;
  gap8_devices::Signals signals_;
  std::vector<std::unique_ptr<Device>> owned_;
  std::vector<Member> members_;
  std::vector<Slot> slots_;
  PowerManager* power_manager_ = nullptr;
  gap8_devices::EventUnit* event_unit_ = nullptr;
  Cached cached_;
  Picoseconds next_event_ = kNever;
};

}  // namespace mebots::soc
