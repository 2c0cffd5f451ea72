// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/assert.hpp"

#include "cluster/cluster.hpp"
#include "hart/csr_numbers.hpp"
#include "hart/observer.hpp"

namespace mebots::soc {

/// One core of the cluster: its hart, where its cycles lie in the cluster's ticks, and its turn at shared devices.
class Cluster::Core final : private Bus {
 public:
  Core(Cluster& cluster, unsigned id, Memory& memory)
      : cluster_(cluster),
        id_(id),
        hart_(memory, *this, cluster.decoded_,
              {.id = id,
               .has_gap8_interrupts = cluster.settings_.has_gap8_interrupts,
               .translate = cluster.settings_.translate}),
        schedule_(cluster.banks_),
        way_(cluster.way_),
        ready_(cluster.ready_[id]) {
    connect(1);
  }

  /// To the memories, as the cluster's settings have them; an access outside keeps the way there for so many ticks.
  void connect(std::uint32_t access_ticks) {
    const auto& settings = cluster_.settings_;
    auto ports = settings.ports;
    for (auto& port : ports) {
      if (settings.shares_way && port.region != settings.l1_region) port.banks = &way_;
    }
    way_.set_ticks(access_ticks);
    hart_.connect(ports);
    share_banks(cluster_.sharing_banks_);
  }

  unsigned id() const { return id_; }
  const Hart& hart() const { return hart_; }
  Hart& hart() { return hart_; }
  /// The tick in which its next instruction starts, or its sleep began.
  std::uint64_t tick() const { return hart_.counters().cycles + offset_; }
  bool waits_for_turn() const { return waits_for_turn_; }
  bool sleeps() const { return asleep_; }
  /// Whether its next run only has to go on in translated code.
  bool can_resume() const { return !waits_for_turn_ && hart_.translated().has_resume_point(); }
  void grant_turn() {
    granted_ = waits_for_turn_;
    waits_for_turn_ = false;
  }
  /// The tick of its last access to a shared device.
  std::uint64_t accessed() const { return accessed_; }

  /// All registers new, from `pc` on.
  void start(std::uint32_t pc, std::uint64_t tick) {
    hart_.restart(pc);
    if (cluster_.settings_.has_gap8_interrupts) hart_.set_csr(csr::kMtvec, pc & ~0xffU);
    set_asleep(false);
    cluster_.note_awake(tick);
    waits_for_turn_ = false;
    granted_ = false;
    go_on_at(tick);
    if (observer_ != nullptr) observer_->switched(hart_, true);
  }
  /// It has not begun yet.
  void halt() {
    set_asleep(true);
    find_ready();
  }
  void stop() {
    if (observer_ != nullptr) observer_->switched(hart_, false);
  }

  void observe(Observer* observer) {
    observer_ = observer;
    hart_.observe(observer);
  }

  void wake(std::uint64_t tick) {
    if (!asleep_) return;
    set_asleep(false);
    cluster_.note_awake(tick);
    hart_.wake();
    go_on_at(tick);
  }

  /// All its interrupt lines. One that it lets in ends its sleep.
  void set_interrupts(std::uint32_t lines, std::uint64_t tick) {
    hart_.set_interrupts(lines);
    if (asleep_ && hart_.sleeping() && hart_.wakes()) wake(tick + kWakeLatency);
  }

  Stop run(std::uint64_t end) { return hart_.run(end - offset_); }
  /// Its hart has run, and came back so.
  void stopped(Stop stop) {
    if (set_asleep(stop == Stop::sleeping)) cluster_.note_asleep(tick());
    find_ready();
  }

  /// Whether others use the banks of L1 at the same time.
  void share_banks(bool several) { hart_.share_first(several ? &schedule_ : nullptr); }

  void visit(state::Visitor& v) {
    bool asleep = asleep_;
    v("hart", hart_);
    v("offset", offset_);
    v("asleep", asleep);
    v("waits_for_turn", waits_for_turn_);
    if (!v.restores()) return;
    set_asleep(asleep);
    granted_ = false;
    apply_offset();
    find_ready();
  }

 private:
  /// Whether that is a change.
  bool set_asleep(bool asleep) {
    if (asleep == asleep_) return false;
    MEBOTS_ASSERT(asleep ? cluster_.awake_ > 0 : cluster_.awake_ < kMostClusterCores);
    asleep_ = asleep;
    asleep ? --cluster_.awake_ : ++cluster_.awake_;
    return true;
  }
  void find_ready() { ready_ = asleep_ ? kNoTick : tick(); }
  void go_on_at(std::uint64_t tick) {
    offset_ = tick - hart_.counters().cycles;
    apply_offset();
    find_ready();
  }
  void apply_offset() {
    schedule_.set_offset(offset_);
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
    accessed_ = cycle + offset_;
    return cluster_.access({id_, address, accessed_, stored, event, size});
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
    cluster_.peripherals_->interrupt_taken(id_, line);
    hart_.set_interrupts(cluster_.peripherals_->lines(id_));
  }
  bool watched(std::uint32_t address) override { return cluster_.watcher_ && cluster_.watcher_(address); }

  Cluster& cluster_;
  unsigned id_;
  Hart hart_;
  BankSchedule schedule_;  // of L1
  BankSchedule way_;       // to the SoC
  std::uint64_t& ready_;   // of the cluster's
  Observer* observer_ = nullptr;
  std::uint64_t offset_ = 0;
  std::uint64_t accessed_ = 0;
  bool asleep_ = true;
  bool waits_for_turn_ = false;
  bool granted_ = false;
};

}  // namespace mebots::soc
