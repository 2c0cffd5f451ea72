// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "board/chip.hpp"
#include "board/settings.hpp"
#include "cluster/cluster.hpp"
#include "elf/elf.hpp"
#include "energy/meter.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"
#include "runs/hart.hpp"
#include "soc/device_services.hpp"
#include "soc/device_set.hpp"
#include "soc/hardware.hpp"
#include "soc/power_account.hpp"
#include "soc/program_host.hpp"
#include "soc/state_times.hpp"
#include "soc/system_bus.hpp"
#include "soc/timeline.hpp"
#include "soc/work_account.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>

namespace mebots::soc {

/// The chip with its devices and its program.
///
/// Time: `advance(t)` executes every instruction of the fabric controller that starts at or before t, and every event
/// of a device up to t. Therefore a request that the program makes at time s is visible outside after the first call
/// with t >= s.
///
/// Order: while the fabric controller is awake, it is ahead of the cluster by at most kLead ticks of the cluster, and
/// never behind. Its accesses to the cluster's registers and to the power manager wait until the cluster has reached
/// the same time. While the fabric controller sleeps, the cluster runs up to the next event of a device or up to an
/// event that wakes the fabric controller. The fabric controller and the cluster receive each other's events in the
/// order of time. Exception: an interrupt from the cluster may reach an awake fabric controller up to kLead ticks late.
class Soc final {
 public:
  static constexpr Picoseconds kWithoutEnd = kNever - 1;

  /// Throws Error if board, settings and program are not compatible.
  Soc(const BoardDescription& board, const Chip& chip, const Settings& settings, const Elf& program,
      Listeners listeners);
  Soc(const Soc&) = delete;
  Soc& operator=(const Soc&) = delete;

  /// Begins a communication step. The parameters and inputs of the devices must already be set.
  void begin_step();
  /// Advances the chip to `time_ns`, which must not be in the past.
  void advance(std::int64_t time_ns);
  /// Runs until a core has executed `cycle_limit` active cycles, until time `until`, until the end of the program, or
  /// until a sleep that no event can end. Used by `mebots-soc run`, without FMI.
  void run_cycles(std::uint64_t cycle_limit, Picoseconds until = kWithoutEnd);
  /// Switches the supply off. Afterwards, nothing runs or consumes energy.
  void power_off();

  End end() const { return timeline_.end(); }
  bool running() const { return timeline_.running(); }
  std::int32_t exit_code() const;
  /// Returns true if the fabric controller sleeps, and no event of a device or of the cluster will ever occur.
  bool sleeps_for_good();
  /// Returns true if the fabric controller is in an endless loop that no interrupt can end.
  bool spins() const { return running() && hart().spins(); }
  /// If a core ended the program with an error code while it was in an exception handler, returns this core. Otherwise,
  /// and also if the exception was an ecall, returns nullopt.
  std::optional<int> gave_up() const;
  /// Returns true if a core cannot continue, or ended the program in an exception handler.
  bool faulted() const;
  /// Returns a text that explains why a core cannot continue, with function, line, instruction and callers. The text is
  /// empty if no core has faulted.
  std::string fault_text() const;
  /// Returns a text like fault_text() about the fabric controller's first exception since a handler last returned. The
  /// text is empty if there is no such exception.
  std::string unfinished_exception_text() const;

  Picoseconds now() const { return timeline_.now(); }
  Picoseconds sleep_time() const { return timeline_.slept_at(now()); }
  /// Returns the start time of a hart's next instruction or of its sleep. Used by observers during a run.
  Picoseconds core_time(unsigned number = kFabricControllerHart) const;
  /// Returns the start time of an active cycle of a hart. Since that cycle, the hart must not have slept, and its clock
  /// must not have changed.
  Picoseconds core_time_at(unsigned number, std::uint64_t cycle) const;

  Hart& hart() { return hardware_.controller(); }
  const Hart& hart() const { return hardware_.controller(); }
  /// Returns the hart with this number; see cluster/peripherals.hpp.
  Hart& hart(unsigned number) { return hardware_.hart(number); }
  const Hart& hart(unsigned number) const { return hardware_.hart(number); }
  unsigned harts() const { return hardware_.harts(); }
  /// Returns true if the hart can run. The cores of a cluster that is off cannot.
  bool is_on(unsigned number) const { return number == kFabricControllerHart || cluster()->powered(); }
  /// Returns the number of instructions that all cores have retired since the start.
  std::uint64_t instructions() const;
  /// Returns the cluster, or null if the chip has none.
  const Cluster* cluster() const { return hardware_.cluster(); }
  /// Returns the fabric controller's instruction cache, or null if it has none.
  const InstructionCache* instruction_cache() const { return hardware_.instruction_cache(); }
  const Memory& memory() const { return hardware_.memory(); }
  bool poke(std::uint32_t address, std::span<const std::uint8_t> bytes) { return hardware_.poke(address, bytes); }

  const Elf& program() const { return program_; }
  const BoardDescription& board() const { return board_; }
  const DeviceSet& devices() const { return devices_; }
  const PowerAccount& power() const { return power_; }
  const EnergyChecks& energy_checks() const { return hardware_.chip().checks; }
  EnergyLedger energy() const { return power_.energy_at(now()); }
  const StateTimes& state_times() const { return work_.state_times(); }
  const Decisions& decisions() const { return work_.decisions(); }
  ProgramHost& program_host() { return program_host_; }

  /// Sets the observer of a hart; null removes it. Not part of a saved state.
  void observe(unsigned number, Observer* observer);
  /// Sets the listener for changes of the chip's state; null removes it. Not part of a saved state.
  void listen(StateListener* listener) {
    listener_ = listener;
    bus_.set_listening(listener != nullptr);
  }

  void visit(state::Visitor& v);

 private:
  static constexpr std::uint64_t kLead = 256;
  static constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

  void run(Picoseconds until, std::uint64_t cycle_limit, bool is_alone);
  bool run_controller(Picoseconds until, std::uint64_t cycle_limit, Picoseconds event);
  void handle(Stop stop);
  Picoseconds next_event();
  Picoseconds cluster_next() const { return timeline_.next_of(hardware_.cluster()); }
  void advance_cluster(Picoseconds until, Picoseconds last, std::uint64_t cycle_limit = kNoLimit);
  void advance_devices(Picoseconds time);
  void update_lines();
  void apply_power_settings(Picoseconds time);
  void wake_if_interrupted(Picoseconds time);
  void notify(Picoseconds time);
  void report_fault() const;
  void finish(End why, Picoseconds time);
  void end_by_program(Picoseconds time);

  Listeners listeners_;
  Elf program_;
  BoardDescription board_;
  DeviceSet devices_;
  SystemBus bus_;
  Hardware hardware_;
  Timeline timeline_;
  ProgramHost program_host_;
  PowerAccount power_;
  WorkAccount work_;
  DeviceServices services_;
  StateListener* listener_ = nullptr;
};

}  // namespace mebots::soc
