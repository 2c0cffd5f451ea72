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

/// What cores of a cluster reach outside the RAM: as Bus, of several cores, in the cluster's ticks.
class ClusterBus {
 public:
  virtual ~ClusterBus() = default;
  virtual BusReply access(const ClusterAccess& access) = 0;
  /// The core takes the interrupt of this line. The answer is which of its lines are up then.
  virtual std::uint32_t interrupt_taken(unsigned core, unsigned line) = 0;
  /// Called after a store into a watched word. True: the run ends with this store.
  virtual bool watched(std::uint32_t address) = 0;
};

/// One core of a cluster: its hart, where its cycles lie in the cluster's ticks, and its turn at shared devices.
class ClusterCore final : private Bus {
 public:
  /// `code` is that of all cores, which share its banks: those of L1. `way`: to the SoC, likewise, if the settings say
  /// so. All of it outlives the core.
  ClusterCore(ClusterBus& bus, const ClusterSettings& settings, unsigned id, Memory& memory, DecodedCode& code,
              Banks& way)
      : bus_(bus),
        settings_(settings),
        id_(id),
        hart_(memory, *this, code, {.id = id, .has_gap8_interrupts = settings.has_gap8_interrupts}),
        l1_(*code.banks),
        way_(way) {
    connect(1);
  }

  /// To the memories, as the settings have them; an access outside keeps the way there for so many ticks.
  void connect(std::uint32_t access_ticks) {
    auto ports = settings_.ports;
    for (auto& port : ports) {
      if (settings_.shares_way && port.region != settings_.l1_region) port.banks = &way_;
    }
    way_.set_ticks(access_ticks);
    hart_.connect(ports);
    share_banks(shares_banks_);
  }

  unsigned id() const { return id_; }
  const Hart& hart() const { return hart_; }
  Hart& hart() { return hart_; }

  // Its time.

  /// The tick in which its next instruction starts, or its sleep began.
  std::uint64_t tick() const { return tick_of(hart_.counters().cycles); }
  /// The tick of one of its active cycles, since when it has not slept.
  std::uint64_t tick_of(std::uint64_t cycle) const { return cycle + offset_; }
  bool sleeps() const { return asleep_; }
  /// The tick in which its next instruction starts; kNoTick while it sleeps.
  std::uint64_t ready() const { return asleep_ ? kNoTick : tick(); }

  /// All registers new, from `pc` on.
  void start(std::uint32_t pc, std::uint64_t tick) {
    hart_.restart(pc);
    if (settings_.has_gap8_interrupts) hart_.set_csr(csr::kMtvec, pc & ~0xffU);
    asleep_ = false;
    waits_for_turn_ = false;
    granted_ = false;
    go_on_at(tick);
    if (observer_ != nullptr) observer_->switched(hart_, true);
  }
  /// It has not begun yet.
  void halt() { asleep_ = true; }
  void stop() {
    if (observer_ != nullptr) observer_->switched(hart_, false);
  }
  /// What it waited for has come; it goes on in this tick. False: it was awake.
  bool wake(std::uint64_t tick) {
    if (!asleep_) return false;
    asleep_ = false;
    hart_.wake();
    go_on_at(tick);
    return true;
  }
  /// All its interrupt lines. One that it lets in ends its sleep; it goes on in this tick then. False: no sleep ends.
  bool set_interrupts(std::uint32_t lines, std::uint64_t tick) {
    hart_.set_interrupts(lines);
    return asleep_ && hart_.sleeping() && hart_.wakes() && wake(tick);
  }

  // Its runs.

  Stop run(std::uint64_t end) { return hart_.run(end - offset_); }
  /// Its hart came back so.
  void stopped(Stop stop) { asleep_ = stop == Stop::sleeping; }
  /// Whether its next run only has to go on in translated code.
  bool can_resume() const { return !waits_for_turn_ && hart_.has_resume_point(); }
  /// Whether others use the banks of L1 at the same time.
  void share_banks(bool several) {
    shares_banks_ = several;
    hart_.share_first(several ? &l1_ : nullptr);
  }
  void observe(Observer* observer) {
    observer_ = observer;
    hart_.observe(observer);
  }

  // Its turn.

  /// Whether it stands in front of an access to a shared device.
  bool waits_for_turn() const { return waits_for_turn_; }
  /// No other core is behind it: in its next run it may go on with that access.
  void grant_turn() {
    granted_ = waits_for_turn_;
    waits_for_turn_ = false;
  }
  /// The tick of its last access to a shared device.
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
  void go_on_at(std::uint64_t tick) {
    offset_ = tick - hart_.counters().cycles;
    apply_offset();
  }
  void apply_offset() {
    l1_.set_offset(offset_);
    way_.set_offset(offset_);
    hart_.set_tick_offset(offset_);
  }

  BusReply turn(std::uint32_t address, std::uint64_t cycle, const std::uint32_t* stored, bool event,
                unsigned size = 4) {
    if (!granted_) {
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
    granted_ = false;  // the handler runs before the access that had its turn, and has accesses of its own
    hart_.set_interrupts(bus_.interrupt_taken(id_, line));
  }
  bool watched(std::uint32_t address) override { return bus_.watched(address); }

  ClusterBus& bus_;
  const ClusterSettings& settings_;
  unsigned id_;
  Hart hart_;
  BankSchedule l1_;
  BankSchedule way_;  // to the SoC
  bool shares_banks_ = false;
  Observer* observer_ = nullptr;
  std::uint64_t offset_ = 0;
  std::uint64_t accessed_ = 0;
  bool asleep_ = true;
  bool waits_for_turn_ = false;
  bool granted_ = false;
};

}  // namespace mebots::soc
