// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"
#include "cluster/settings.hpp"
#include "hart/csr_numbers.hpp"
#include "hart/observer.hpp"
#include "memory/banks.hpp"
#include "memory/bus.hpp"
#include "runs/hart.hpp"

#include "mebots/state/visitor.hpp"

#include <cstdint>

namespace mebots::soc {

/// Performs the accesses of all cores of a cluster to devices. Corresponds to Bus, but counts time in ticks of the
/// cluster.
class ClusterBus {
 public:
  virtual ~ClusterBus() = default;
  virtual BusReply access(const ClusterAccess& access) = 0;
  /// Returns true if exactly one core is awake, and this core may access shared devices in this tick without waiting
  /// for grant_turn().
  virtual bool permits_at_once(std::uint64_t tick) = 0;
  /// Called when a core takes the interrupt of a line. Returns the lines that are pending afterwards.
  virtual std::uint32_t interrupt_taken(unsigned core, unsigned line) = 0;
  /// Called after a store into a word that the host watches, such as `tohost`. The run ends if the function returns
  /// true.
  virtual bool watched(std::uint32_t address) = 0;
};

/// Models a core of a cluster: its hart, the conversion of its cycles to ticks, and its permission to access shared
/// devices.
class ClusterCore final : private Bus {
 public:
  /// `code` is the decoded code of all cores, and contains the banks of L1. `way` is the port to the SoC, which the
  /// cores may share (ClusterSettings::shares_soc_port). All references must outlive the core.
  ClusterCore(ClusterBus& bus, const ClusterSettings& settings, unsigned id, Memory& memory, DecodedCode& code,
              Banks& way)
      : bus_(bus),
        settings_(settings),
        id_(id),
        hart_(memory, *this, code, {.id = id, .has_gap8_interrupts = settings.has_gap8_interrupts}),
        l1_(*code.banks),
        soc_port_(way) {
    connect(1);
  }

  /// Sets the latencies of the memories. An access to a memory outside the cluster occupies the shared port for
  /// `access_ticks` ticks.
  void connect(std::uint32_t access_ticks) {
    auto ports = settings_.ports;
    for (auto& port : ports) {
      if (settings_.shares_soc_port && port.region != settings_.l1_region) port.banks = &soc_port_;
    }
    soc_port_.set_ticks(access_ticks);
    hart_.connect(ports);
    share_banks(shares_banks_);
  }

  unsigned id() const { return id_; }
  const Hart& hart() const { return hart_; }
  Hart& hart() { return hart_; }

  /// Returns the tick in which the core's next instruction starts, or in which its sleep began.
  std::uint64_t tick() const { return tick_of(hart_.counters().cycles); }
  /// Returns the tick of an active cycle. The core must not have slept since that cycle.
  std::uint64_t tick_of(std::uint64_t cycle) const { return cycle + offset_; }
  bool sleeps() const { return asleep_; }
  /// Returns the tick in which the core's next instruction starts, or kNoTick if the core sleeps.
  std::uint64_t ready() const { return asleep_ ? kNoTick : tick(); }

  /// Resets all registers and starts the core at `pc`.
  void start(std::uint32_t pc, std::uint64_t tick) {
    hart_.restart(pc);
    if (settings_.has_gap8_interrupts) hart_.set_csr(csr::kMtvec, pc & ~0xffU);
    asleep_ = false;
    waits_for_turn_ = false;
    granted_ = false;
    resume_at(tick);
    if (observer_ != nullptr) observer_->switched(hart_, true);
  }
  /// Puts the core to sleep without a call of the observer.
  void halt() { asleep_ = true; }
  void stop() {
    if (observer_ != nullptr) observer_->switched(hart_, false);
  }
  /// Wakes the core in this tick. Returns false if the core was already awake.
  bool wake(std::uint64_t tick) {
    if (!asleep_) return false;
    asleep_ = false;
    hart_.wake();
    resume_at(tick);
    return true;
  }
  /// Sets all interrupt lines of the core. A line that is active and enabled wakes the core in this tick. Returns true
  /// if the core wakes.
  bool set_interrupts(std::uint32_t lines, std::uint64_t tick) {
    hart_.set_interrupts(lines);
    return asleep_ && hart_.sleeping() && hart_.wakes() && wake(tick);
  }

  Stop run(std::uint64_t end) { return hart_.run(end - offset_); }
  /// Must be called with the reason why the last run ended.
  void stopped(Stop stop) { asleep_ = stop == Stop::sleeping; }
  bool can_resume() const { return !waits_for_turn_ && hart_.has_resume_point(); }
  /// Sets whether other cores or the DMA may use the banks of L1 at the same time as this core.
  void share_banks(bool several) {
    shares_banks_ = several;
    hart_.share_first(several ? &l1_ : nullptr);
  }
  void observe(Observer* observer) {
    observer_ = observer;
    hart_.observe(observer);
  }

  /// Returns true if the core waits for permission to access a shared device.
  bool waits_for_turn() const { return waits_for_turn_; }
  /// Permits the access for which the core waits, if any. Must only be called if no other core has an earlier tick. The
  /// core performs the access in its next run.
  void grant_turn() {
    granted_ = waits_for_turn_;
    waits_for_turn_ = false;
  }
  /// Returns the tick of the core's last access to a shared device.
  std::uint64_t accessed() const { return accessed_; }

  void visit(state::Visitor& v) {
    v("hart", hart_);
    v("offset", offset_);
    v("asleep", asleep_);
    v("waits_for_turn", waits_for_turn_);
    if (!v.restores()) return;
    granted_ = false;
    apply_offset();
  }

 private:
  void resume_at(std::uint64_t tick) {
    offset_ = tick - hart_.counters().cycles;
    apply_offset();
  }
  void apply_offset() {
    l1_.set_offset(offset_);
    soc_port_.set_offset(offset_);
    hart_.set_tick_offset(offset_);
  }

  BusReply turn(std::uint32_t address, std::uint64_t cycle, const std::uint32_t* stored, bool event,
                unsigned size = 4) {
    if (!granted_ && !bus_.permits_at_once(tick_of(cycle))) {
      waits_for_turn_ = true;
      return {BusReply::Kind::later};
    }
    granted_ = false;
    accessed_ = tick_of(cycle);
    return bus_.access({id_, address, accessed_, stored, event, size});
  }
  BusReply load(std::uint32_t address, std::uint64_t cycle) override { return turn(address, cycle, nullptr, false); }
  BusReply load_event(std::uint32_t address, std::uint64_t cycle) override {
    return turn(address, cycle, nullptr, true);
  }
  BusReply store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) override {
    return turn(address, cycle, &value, false);
  }
  BusReply store_narrow(std::uint32_t address, std::uint64_t cycle, std::uint32_t value, unsigned size) override {
    return turn(address, cycle, &value, false, size);
  }
  void interrupt_taken(unsigned line) override {
    granted_ = false;  // the handler runs before the permitted access, and its own accesses need new permission
    hart_.set_interrupts(bus_.interrupt_taken(id_, line));
  }
  bool watched(std::uint32_t address) override { return bus_.watched(address); }

  ClusterBus& bus_;
  const ClusterSettings& settings_;
  unsigned id_;
  Hart hart_;
  BankSchedule l1_;
  BankSchedule soc_port_;  // claims of the port to the SoC
  bool shares_banks_ = false;
  Observer* observer_ = nullptr;
  std::uint64_t offset_ = 0;
  std::uint64_t accessed_ = 0;
  bool asleep_ = true;
  bool waits_for_turn_ = false;
  bool granted_ = false;
};

}  // namespace mebots::soc
