// SPDX-License-Identifier: Apache-2.0
#include "soc.hpp"

#include "hart/csr_numbers.hpp"
#include "isa/encoding.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

namespace mebots::soc {
namespace {

Memory make_memory(const BoardDescription& board) {
  Memory memory;
  // The largest first: the core reaches the first one fastest.
  auto sorted = board.memories;
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.size > b.size; });
  for (const auto& entry : sorted) memory.add(entry.name, entry.base, entry.size);
  return memory;
}

std::uint32_t total_size(const Memory& memory) {
  std::uint32_t total = 0;
  for (const auto& region : memory.regions()) total += region.size;
  return total;
}

std::uint32_t checked_clock(const Chip& chip, const Settings& settings) {
  const auto clock_hz = static_cast<std::uint32_t>(std::llround(settings.clock_hz));
  const auto voltage_mv = static_cast<std::uint32_t>(std::lround(settings.voltage_v * kMilli));
  if (!chip.allows(clock_hz, voltage_mv)) {
    throw Error(
        fmt::format("core.clock {} Hz at core.supply_voltage {} V is outside the chip's limits: {} to {} V, and {} to "
                    "{:.0f} Hz at {} V",
                    settings.clock_hz, settings.voltage_v, chip.lowest_voltage_v, chip.highest_voltage_v,
                    chip.minimum_clock_hz, chip.highest_clock_hz(settings.voltage_v), settings.voltage_v));
  }
  return clock_hz;
}

template <std::size_t Count>
void check_registers(const BoardDevice& device, const std::array<board::RegisterName, Count>& expected) {
  bool same = device.registers.size() == Count;
  for (std::size_t i = 0; same && i < Count; ++i) {
    same = device.registers[i].name == expected[i].name && device.registers[i].offset == expected[i].offset;
  }
  if (!same) {
    throw Error(
        fmt::format("board: the registers of device {} are not those that this build was made with; build again "
                    "with this board file",
                    device.name));
  }
}

std::string_view cause_text(std::uint32_t cause) {
  if ((cause & cause::kInterrupt) != 0) return "interrupt";
  switch (cause) {
    case cause::kFetchAccess:
      return "instruction fetch from nothing";
    case cause::kIllegalInstruction:
      return "illegal instruction";
    case cause::kBreakpoint:
      return "ebreak";
    case cause::kLoadAccess:
      return "load from nothing";
    case cause::kStoreAccess:
      return "store into nothing";
    case cause::kMachineEcall:
      return "ecall";
    default:
      return "trap";
  }
}

}  // namespace

Soc::Soc(const BoardDescription& board, const Chip& chip, const Settings& settings, const Elf& program,
         Listeners listeners)
    : chip_(chip),
      listeners_(std::move(listeners)),
      program_(program),
      memory_(make_memory(board)),
      hart_(memory_, *this, chip.timing, chip.instruction_energy),
      meter_(chip, total_size(memory_), settings.voltage_v),
      voltage_mv_(static_cast<std::uint32_t>(std::lround(settings.voltage_v * kMilli))) {
  clock_.reset(checked_clock(chip, settings));
  add_devices(board, settings);
  load_program();
  hart_.reset(program_.entry());
}

void Soc::add_devices(const BoardDescription& board, const Settings& settings) {
  const auto add = [this](const BoardDevice& entry, const auto& registers, Device& device) {
    check_registers(entry, registers);
    const auto size = registers.back().offset + 4;
    for (const auto& slot : slots_) {
      if (entry.base < slot.base + slot.size && slot.base < entry.base + size) {
        throw Error(fmt::format("board: devices {} and {} overlap at 0x{:08x}", entry.name, slot.name, entry.base));
      }
    }
    if (memory_.find(entry.base, 4) != nullptr) {
      throw Error(fmt::format("board: device {} at 0x{:08x} lies inside a memory", entry.name, entry.base));
    }
    slots_.push_back({entry.name, entry.base, size, entry.interrupt, &device});
  };
  const auto complain = [this](std::string_view text) {
    if (listeners_.faults) listeners_.faults(text);
  };
  for (const auto& entry : board.devices) {
    if (entry.name == "console") {
      console_ = std::make_unique<Console>(listeners_.console);
      add(entry, board::console::kRegisters, *console_);
    } else if (entry.name == "timer") {
      timer_ = std::make_unique<Timer>();
      add(entry, board::timer::kRegisters, *timer_);
    } else if (entry.name == "power_manager") {
      power_manager_ = std::make_unique<PowerManager>(chip_, clock_.hz(), voltage_mv_);
      add(entry, board::power_manager::kRegisters, *power_manager_);
    } else if (entry.name == "camera") {
      camera_ = std::make_unique<Camera>(entry, settings.frame_width, memory_, complain);
      add(entry, board::camera::kRegisters, *camera_);
    } else if (entry.name == "flight") {
      flight_ = std::make_unique<Flight>(complain);
      add(entry, board::flight::kRegisters, *flight_);
    } else if (entry.name == "battery") {
      battery_ = std::make_unique<BatteryGauge>();
      add(entry, board::battery::kRegisters, *battery_);
    } else if (entry.name == "mission") {
      mission_ = std::make_unique<MissionParameters>(settings.mission);
      add(entry, board::mission::kRegisters, *mission_);
    } else {
      throw Error(
          fmt::format("board: no model for device \"{}\"; known are console, timer, power_manager, camera, "
                      "flight, battery and mission",
                      entry.name));
    }
  }
}

void Soc::load_program() {
  for (const auto& segment : program_.segments()) {
    auto* region = memory_.find(segment.address, segment.size);
    if (region == nullptr) {
      throw Error(
          fmt::format("{}: segment at 0x{:08x} with {} bytes lies outside the board's memories; link it with the "
                      "board's addresses",
                      program_.origin(), segment.address, segment.size));
    }
    memory_.write(segment.address, segment.bytes);
  }
}

void Soc::stop_when_stored(std::uint32_t address) {
  stop_word_ = address;
  memory_.mark(address, 4, Region::kWatch);
}

const Soc::Slot* Soc::slot_at(std::uint32_t address) const {
  for (const auto& slot : slots_) {
    if (address >= slot.base && address - slot.base < slot.size) return &slot;
  }
  return nullptr;
}

bool Soc::load(std::uint32_t address, std::uint64_t cycle, std::uint32_t& value) {
  const auto* slot = slot_at(address);
  return slot != nullptr && slot->device->load(address - slot->base, clock_.time_of(cycle), value);
}

bool Soc::store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) {
  const auto* slot = slot_at(address);
  return slot != nullptr && slot->device->store(address - slot->base, clock_.time_of(cycle), value);
}

bool Soc::watched(std::uint32_t /*address*/) {
  std::uint32_t word = 0;
  return stop_word_ && memory_.read(*stop_word_, {reinterpret_cast<std::uint8_t*>(&word), sizeof word}) && word != 0;
}

void Soc::advance(std::int64_t time_ns) {
  go_on(time_ns * kPsPerNs, std::numeric_limits<std::uint64_t>::max());
}

void Soc::run_cycles(std::uint64_t cycle_limit) {
  go_on(kNever - 1, cycle_limit);
}

void Soc::go_on(Picoseconds until, std::uint64_t cycle_limit) {
  for (;;) {
    const auto event = next_event();
    const bool event_comes = event <= until;
    if (asleep_) {
      if (!event_comes) break;
      advance_devices(event);
      wake_if_interrupted(event);
      continue;
    }
    const auto limit = event_comes ? clock_.first_at(event) : clock_.first_after(until);
    const auto stop = hart_.run(std::min(limit, cycle_limit));
    if (stop != Stop::limit) {
      handle(stop);
      continue;
    }
    if (event_comes && hart_.counters().cycles >= limit) {
      advance_devices(event);
      continue;
    }
    if (hart_.counters().cycles >= limit) break;
    now_ = core_time();  // the cycle limit
    return;
  }
  now_ = until == kNever - 1 ? (asleep_ ? std::max(now_, asleep_since_) : core_time()) : until;
}

void Soc::handle(Stop stop) {
  switch (stop) {
    case Stop::device:
      apply_power_settings();
      update_lines();
      if (power_manager_ && power_manager_->exited()) finish(End::exited);
      break;
    case Stop::sleeping:
      asleep_ = true;
      asleep_since_ = core_time();
      break;
    case Stop::watch:
      finish(End::host);
      break;
    case Stop::fault:
      finish(End::faulted);
      if (listeners_.faults) listeners_.faults(fault_text());
      break;
    case Stop::limit:
      break;
  }
}

void Soc::finish(End why) {
  end_ = why;
  end_time_ = core_time();
  asleep_ = true;
  asleep_since_ = end_time_;
  if (console_) console_->flush();
}

void Soc::power_off() {
  if (end_ == End::powered_off) return;
  if (asleep_ && now_ > asleep_since_) slept_ += now_ - asleep_since_;
  end_ = End::powered_off;
  end_time_ = now_;
  asleep_ = true;
  asleep_since_ = kNever;
  if (console_) console_->flush();
}

Picoseconds Soc::next_event() const {
  if (end_ == End::powered_off) return kNever;
  auto next = kNever;
  for (const auto& slot : slots_) next = std::min(next, slot.device->next_event());
  return next;
}

void Soc::advance_devices(Picoseconds time) {
  for (const auto& slot : slots_) slot.device->advance(time);
  update_lines();
}

void Soc::update_lines() {
  for (const auto& slot : slots_) {
    if (slot.interrupt >= 0) hart_.set_interrupt(static_cast<unsigned>(slot.interrupt), slot.device->interrupt());
  }
}

void Soc::apply_power_settings() {
  if (!power_manager_) return;
  if (power_manager_->clock_hz() != clock_.hz()) {
    clock_.change(power_manager_->clock_hz(), hart_.counters().cycles);
  }
  if (power_manager_->voltage_mv() != voltage_mv_) {
    voltage_mv_ = power_manager_->voltage_mv();
    now_ = core_time();
    meter_.change_voltage(voltage_mv_ / kMilli, activity());
  }
}

void Soc::wake_if_interrupted(Picoseconds time) {
  if (end_ != End::none || !hart_.wakes()) return;
  const auto wake = std::max(time, asleep_since_);
  clock_.wake(hart_.counters().cycles, wake);
  slept_ += core_time() - asleep_since_;
  asleep_ = false;
}

Picoseconds Soc::sleep_time() const {
  return slept_ + (asleep_ && now_ > asleep_since_ ? now_ - asleep_since_ : 0);
}

Activity Soc::activity() const {
  const auto& counters = hart_.counters();
  Activity activity;
  activity.instruction_fj = counters.instruction_fj;
  activity.memory_accesses = counters.accesses - counters.device_accesses;
  activity.device_accesses = counters.device_accesses;
  activity.powered = supplied_until();
  activity.asleep = sleep_time();
  return activity;
}

std::string Soc::fault_text() const {
  const auto& fault = hart_.fault();
  if (!fault.happened) return {};
  const auto function = program_.where(fault.pc);
  return fmt::format("{}: {} (mcause {}, mtval 0x{:08x}) at pc 0x{:08x} in {}: {}",
                     fault.double_trap ? "no way out of its own trap handler" : "trap without a handler",
                     cause_text(fault.cause), fault.cause, fault.value, fault.pc,
                     function.empty() ? "no function of the program" : function,
                     fault.instruction == 0 ? "no instruction there" : disassemble(fault.instruction, fault.pc));
}

void Soc::save(state::Writer& writer) const {
  static_assert(std::has_unique_object_representations_v<Clock>);
  memory_.save(writer);
  hart_.save(writer);
  for (const auto& slot : slots_) slot.device->save(writer);
  meter_.save(writer);
  writer.put(clock_);
  writer.put(voltage_mv_);
  writer.put(now_);
  writer.put(end_);
  writer.put(end_time_);
  writer.put(asleep_);
  writer.put(asleep_since_);
  writer.put(slept_);
}

void Soc::restore(state::Reader& reader) {
  memory_.restore(reader);
  hart_.restore(reader);
  for (const auto& slot : slots_) slot.device->restore(reader);
  meter_.restore(reader);
  reader.get(clock_);
  reader.get(voltage_mv_);
  reader.get(now_);
  reader.get(end_);
  reader.get(end_time_);
  reader.get(asleep_);
  reader.get(asleep_since_);
  reader.get(slept_);
}

}  // namespace mebots::soc
