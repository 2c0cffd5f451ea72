// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "board/chip.hpp"
#include "board/settings.hpp"
#include "clock/clock.hpp"
#include "cluster/cluster.hpp"
#include "devices/core/kinds.hpp"
#include "devices/gap8/event_unit.hpp"
#include "devices/generic/power_manager.hpp"
#include "elf/elf.hpp"
#include "energy/meter.hpp"
#include "hart/hart.hpp"
#include "mebots/soc/device_kind.hpp"
#include "memory/bus.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"
#include "soc/decisions.hpp"
#include "soc/host_calls.hpp"
#include "soc/state_times.hpp"
#include "soc/unmodelled_registers.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::soc {

/// Who listens to a system. Each may be empty.
struct Listeners {
  std::function<void(std::string_view line)> console;
  std::function<void(std::string_view text)> faults;
  std::function<void(std::string_view text)> observe = {};  // of debugger and profile
};

/// Why a system does not run any more.
enum class End : std::uint8_t { none, exited, faulted, powered_off, host, stopped };

/// The chip with its devices and its program: a core that runs while time goes on.
///
/// Time rule: `advance(t)` executes every instruction of the fabric controller that starts at or before t, and every
/// event of a device up to t. So a request made at SoC time s is out at the first call with t >= s.
///
/// Fabric controller and cluster: awake, the fabric controller goes ahead, by at most kLead ticks of the cluster; the
/// cluster follows and never passes it. Its access to the cluster's devices, or to the power manager, waits until the
/// cluster has come to the same time. Asleep, it lets the cluster run up to the next event of a device; it wakes at the
/// time of the cluster's event. So both see each other's events in the order of time; only an interrupt from the
/// cluster may find an awake fabric controller up to kLead ticks further on.
class Soc final : private Bus {
 public:
  /// Throws Error for a board, settings or a program that do not fit.
  Soc(const BoardDescription& board, const Chip& chip, const Settings& settings, const Elf& program,
      Listeners listeners);
  Soc(const Soc&) = delete;
  Soc& operator=(const Soc&) = delete;

  /// Goes on to `time_ns`, which may not lie in the past.
  void advance(std::int64_t time_ns);
  /// Goes on until a core has `cycle_limit` active cycles behind it, the end, or a sleep that nothing can end. For
  /// programs run alone.
  void run_cycles(std::uint64_t cycle_limit);
  /// Retired by all cores since the start.
  std::uint64_t instructions() const;

  /// Stops at the store that sets bit 0 of this word, unless it is half of a command to a device of the host. Throws
  /// Error when it is not in RAM.
  void stop_when_stored(std::uint32_t address);
  /// Who serves the program's calls to the host from now on, or null: the fabric controller's by semihosting, all
  /// cores' system calls through the word of stop_when_stored(). For programs run alone; not part of a state.
  void serve_calls(HostCalls* calls) { host_calls_ = calls; }

  /// Whether the fabric controller can only do the same for ever, and the program has not ended.
  bool spins() const { return running() && hart_.spins(); }

  End end() const { return end_; }
  bool running() const { return end_ == End::none; }
  /// The chip loses its supply: nothing runs and nothing is consumed any more.
  void power_off();

  Picoseconds now() const { return now_; }
  /// Null without one.
  const Cluster* cluster() const { return cluster_.get(); }
  const Hart& hart() const { return hart_; }
  Hart& hart() { return hart_; }
  /// All harts by number (hart_number.hpp).
  unsigned harts() const { return 1 + (cluster_ ? cluster_->cores() : 0); }
  const Hart& hart(unsigned number) const {
    return number == kFabricControllerHart ? hart_ : std::as_const(*cluster_).hart(core_of_hart(number));
  }
  Hart& hart(unsigned number) { return number == kFabricControllerHart ? hart_ : cluster_->hart(core_of_hart(number)); }
  /// Whether it can run: a cluster that is off is forgotten.
  bool is_on(unsigned number) const { return number == kFabricControllerHart || cluster_->powered(); }
  /// Who watches a hart from now on, or null. Not part of a state.
  void observe(unsigned number, Observer* observer);
  /// Of the fabric controller; null without one.
  const InstructionCache* instruction_cache() const { return instruction_cache_.get(); }
  const Memory& memory() const { return memory_; }
  /// Changes RAM from outside, between instructions; false, with nothing done, when it is not all in one memory.
  bool poke(std::uint32_t address, std::span<const std::uint8_t> bytes);
  const Elf& program() const { return program_; }
  const BoardDescription& board() const { return board_; }
  EnergyLedger energy() const { return energy_at(now_); }
  const EnergyChecks& energy_checks() const { return chip_.checks; }
  /// For observers, who look in the middle of a run: when the core's next instruction starts, or its sleep began, and
  /// the energy up to then.
  Picoseconds core_time() const { return clock_.time_of(hart_.counters().cycles); }
  EnergyLedger energy_at_core() const { return energy_at(core_time()); }
  EnergyLedger energy_at(Picoseconds time) const;
  /// Likewise of any hart that is on.
  Picoseconds core_time(unsigned number) const {
    return number == kFabricControllerHart ? core_time() : cluster_->core_time(core_of_hart(number));
  }
  /// When one of its active cycles started, since when it has neither slept nor had another clock.
  Picoseconds core_time_at(unsigned number, std::uint64_t cycle) const {
    return number == kFabricControllerHart ? clock_.time_of(cycle)
                                           : cluster_->core_time_at(core_of_hart(number), cycle);
  }
  /// What core `core` of the cluster takes for what it does itself [J], over what it takes with its clock gated.
  double cluster_core_energy_j(unsigned core) const { return meter_.core_j(core, core_activity(core)); }
  /// What one more count of a hart costs now.
  CountEnergy energy_per_count(unsigned number) const;
  /// Words that come for a cycle that the fabric controller waits for its instruction cache.
  double refill_words_per_fetch_cycle() const {
    return instruction_cache_ ? 1.0 * instruction_cache_->words_per_line() / instruction_cache_->refill_cycles() : 0;
  }
  double clock_hz() const { return clock_.hz(); }
  double voltage_v() const { return voltage_mv_ / 1e3; }
  struct DeviceState {
    std::string_view name;
    std::string_view state;
  };
  /// Of those devices that have more than one.
  std::vector<DeviceState> device_states() const;
  /// Who hears of changes of state from now on, or null. Not part of a state.
  void listen(StateListener* listener) { listener_ = listener; }
  /// Whether some camera waits for its picture.
  bool waits_for_picture() const;
  /// Time the core slept, up to now.
  Picoseconds sleep_time() const;
  /// What it did how long, up to now; the instruction under way counts to its end.
  const StateTimes& state_times() const { return state_times_; }
  /// How long its program takes from pictures to set-points.
  const Decisions& decisions() const { return decisions_; }
  std::int32_t exit_code() const {
    if (host_exit_) return static_cast<std::int32_t>(*host_exit_);
    if (signals_.exit_code) return *signals_.exit_code;
    return power_manager_ ? power_manager_->exit_code() : 0;
  }
  /// The first core that ended the program, if its exit code says that something is wrong. It must have taken an
  /// exception from which no handler has returned since. Others that are in handlers do not count.
  std::optional<int> gave_up() const;
  /// Whether a core cannot go on, of the cluster's too, or ended on an exception.
  bool faulted() const {
    return hart_.fault().happened || (cluster_ && cluster_->faulted_core() >= 0) || gave_up().has_value();
  }
  /// Why the core cannot go on, with function, line, instruction and callers; empty without a fault.
  std::string fault_text() const;
  /// The first exception of the fabric controller since a handler returned, as in fault_text(); empty without one.
  std::string unfinished_exception_text() const;

  /// A device on the bus, and its entry in the board file.
  struct BoardSlot {
    const BoardDevice* entry = nullptr;
    Device* device = nullptr;
  };
  /// Parts of the board first, each group in the order of the file; without those that are part of the cluster.
  std::span<const BoardSlot> devices() const { return devices_; }
  /// By its name; null = there is none.
  Device* device(std::string_view name) const;
  /// Energy of a device since the start [J].
  double energy_j(const Device& device) const { return device.energy_j(supplied_until()); }
  /// Where some device keeps this variable of its entry; null = none does. See mebots/soc/device.hpp.
  double* input(std::string_view variable) const;
  const double* output(std::string_view variable) const;
  /// What goes in has been set for the time from now on.
  void begin_step();

  void visit(state::Visitor& v);

 private:
  class Host;

  struct Slot {
    std::string name;
    std::uint32_t base = 0;
    std::uint32_t size = 0;  // bytes
    int interrupt = -1;
    Device* device = nullptr;
    bool sets_power = false;  // clocks, voltage or the cluster's power
  };

  /// What need not be asked of the devices again, since nobody has touched one. Not part of a state.
  struct AskedOfDevices {
    bool next_event = false;
    bool lines = false;  // of interrupts
    bool power = false;  // what they want of it
  };

  static constexpr std::uint64_t kLead = 256;
  static constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

  void connect_memories();
  std::uint32_t wait_of_fabric_controller(std::size_t memory) const;
  void set_ways();
  bool has_ways() const;
  void add_cluster(const Settings& settings);
  void choose_peripherals(ClusterSettings& cluster);
  void add_devices();
  void add_devices_on_bus();
  void check_attachments() const;
  void load_program();
  [[noreturn]] void fail_outside(const ElfSegment& segment, std::string_view what, std::uint32_t address,
                                 std::uint32_t size) const;

  BusReply load(std::uint32_t address, std::uint64_t cycle) override;
  BusReply load_event(std::uint32_t address, std::uint64_t cycle) override;
  BusReply store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) override;
  BusReply load_narrow(std::uint32_t address, std::uint64_t cycle, unsigned size) override;
  BusReply store_narrow(std::uint32_t address, std::uint64_t cycle, std::uint32_t value, unsigned size) override;
  BusReply unmodelled(std::uint32_t address, bool stores, bool by_fabric_controller);
  void interrupt_taken(unsigned line) override;
  BusReply from_cluster(const ClusterAccess& access, Picoseconds time);
  const PowerSettings* power_settings() const;
  bool must_wait(std::uint32_t address, Picoseconds now) const;
  bool watched(std::uint32_t address) override;
  bool called_host() override;
  bool watched_by_cluster();
  std::uint64_t command_to_host() const;
  bool is_half_stored(std::uint64_t command) const;
  bool serve_command(std::uint64_t command);
  void clear_command();
  bool serve_system_call(std::uint32_t block);
  const Slot* slot_at(std::uint32_t address) const;

  void go_on(Picoseconds until, std::uint64_t cycle_limit);
  void handle(Stop stop);
  Picoseconds cluster_next() const;
  void advance_cluster(Picoseconds until, Picoseconds last, std::uint64_t cycle_limit = kNoLimit);
  Picoseconds next_event();
  void advance_devices(Picoseconds time);
  void update_lines();
  void apply_power_settings(Picoseconds time);
  /// Whoever reaches them says so: the bus, an event, the world outside.
  void touch_devices() { asked_ = {}; }
  void wake_if_interrupted(Picoseconds time);
  void tell(Picoseconds time);
  ChipState chip_state() const;
  void finish(End why, Picoseconds time);
  void end_by_program(Picoseconds time);
  Picoseconds reached() const;
  void note_work(Picoseconds time);
  CoreWork work_at(Picoseconds now) const;
  Picoseconds controller_work(Picoseconds now) const;
  Picoseconds slept_at(Picoseconds now) const;
  Picoseconds retention_time(Picoseconds now) const;
  Picoseconds supplied_until() const { return end_ == End::powered_off ? end_time_ : now_; }
  PowerState power_state() const;
  Activity activity_at(Picoseconds now) const;
  CoreActivity core_activity(unsigned core) const;

  const Chip& chip_;
  Listeners listeners_;
  Elf program_;
  Memory memory_;
  std::vector<Place> places_;  // of the memories
  std::vector<Slot> slots_;
  std::unique_ptr<Cluster> cluster_;
  int cluster_interrupt_ = -1;
  BoardDescription board_;
  Kinds kinds_;
  std::vector<std::uint8_t> flash_;
  std::vector<std::vector<std::uint8_t>> pictures_;
  std::unique_ptr<ChipHost> host_;  // of the devices
  gap8_devices::Signals signals_;   // between them
  std::vector<std::unique_ptr<Device>> owned_;
  std::vector<BoardSlot> devices_;
  AskedOfDevices asked_;
  Picoseconds next_event_ = kNever;  // as last asked
  PowerManager* power_manager_ = nullptr;
  gap8_devices::EventUnit* event_unit_ = nullptr;        // GAP8's own, of the fabric controller
  std::unique_ptr<InstructionCache> instruction_cache_;  // of the fabric controller
  DecodedCode decoded_;                                  // likewise
  Hart hart_;
  UnmodelledRegisters unmodelled_;
  StateListener* listener_ = nullptr;
  Clock clock_;
  EnergyMeter meter_;
  double temperature_c_;
  std::uint32_t voltage_mv_ = 0;
  std::optional<std::uint32_t> stop_word_;
  bool has_upper_half_ = false;  // of the stop word: with it, the program commands devices of the host
  HostCalls* host_calls_ = nullptr;
  std::optional<std::uint32_t> host_exit_;  // the program wants the run to end with this

  Picoseconds now_ = 0;
  End end_ = End::none;
  std::int32_t ended_by_ = kFabricControllerCore;
  Picoseconds end_time_ = 0;
  bool asleep_ = false;  // the core waits for an interrupt, or has ended
  Picoseconds asleep_since_ = 0;
  Picoseconds slept_ = 0;      // up to the last waking
  bool retained_ = false;      // this sleep is retention sleep
  Picoseconds retention_ = 0;  // time in it, up to the last waking
  StateTimes state_times_;
  Decisions decisions_;
  bool alone_ = false;               // nobody outside waits for the end of a step; not part of a state
  Picoseconds controller_work_ = 0;  // while the cluster did nothing, up to
  Picoseconds work_noted_ = 0;
  Picoseconds cluster_work_noted_ = 0;
  bool awake_noted_ = true;
};

}  // namespace mebots::soc
