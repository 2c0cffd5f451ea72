// SPDX-License-Identifier: Apache-2.0
#include "cluster/cluster.hpp"

#include "mebots/assert.hpp"

#include <algorithm>

namespace mebots::soc {

Cluster::Cluster(Memory& memory, const ClusterSettings& settings, const InstructionEnergy& energy)
    : settings_(settings),
      instruction_cache_(make_instruction_cache(settings.instruction_cache, InstructionCache::Users::several)),
      banks_(settings.l1_banks),
      decoded_(memory, {.timing = settings.timing,
                        .energy = energy,
                        .loose_limit = true,
                        .instruction_cache = instruction_cache_.get(),
                        .banks = &banks_,
                        .translate = settings.translate}),
      dma_(memory, settings.l1_region, settings.dma),
      peripherals_(settings.make_peripherals(dma_)),
      scheduler_(settings_, decoded_, soc_port_, dma_, *this) {
  MEBOTS_ASSERT(settings.cores > 0 && settings.cores <= kMostClusterCores);
  ClusterBus& bus = *this;
  for (unsigned id = 0; id < settings.cores; ++id) {
    cores_.push_back(std::make_unique<ClusterCore>(bus, settings_, id, memory, decoded_, soc_port_));
    scheduler_.add(*cores_.back());
  }
  clock_.reset(settings.clock_hz);
}

void Cluster::power_on(Picoseconds now, std::uint32_t boot) {
  if (powered()) return;
  powered_.begin(now);
  peripherals_->reset(boot);
  scheduler_.set_alarm(peripherals_->next_tick());
  dma_.reset();
  banks_.free_all();  // cores may have claimed later ticks before power_off()
  soc_port_.free_all();
  if (instruction_cache_) instruction_cache_->flush();
  for (auto& core : cores_) core->halt();
  scheduler_.cores_changed();
  start_cores(tick_at(now));
}

void Cluster::start_cores(std::uint64_t tick) {
  const auto started = peripherals_->take_started();
  if (started == 0) return;
  note_awake(tick);
  for (auto& core : cores_) {
    if ((started >> core->id() & 1U) != 0) core->start(peripherals_->boot_address(core->id()), tick);
  }
  scheduler_.cores_changed();
}

void Cluster::power_off(Picoseconds now) {
  if (!powered()) return;
  MEBOTS_ASSERT(now >= powered_.changed_at(), "time does not go back");
  powered_.end(now);
  if (busy_.runs()) busy_.end(now);
  for (auto& core : cores_) core->stop();
  interrupt_ = false;
  fabric_woken_ = false;
}

void Cluster::set_latencies(const ClusterLatencies& latencies) {
  MEBOTS_ASSERT(latencies.waits.size() == settings_.ports.size());
  for (std::size_t i = 0; i < latencies.waits.size(); ++i) settings_.ports[i].wait_cycles = latencies.waits[i];
  dma_.set_timing(latencies.dma);
  if (instruction_cache_) instruction_cache_->set_refill_cycles(latencies.refill_cycles);
  for (auto& core : cores_) core->connect(std::clamp(latencies.access_ticks, 1U, ClusterLatencies::kMostAccessTicks));
  scheduler_.drop_resume_points();
}

void Cluster::set_clock(Picoseconds now, std::uint32_t hz) {
  MEBOTS_ASSERT(hz > 0);
  if (hz != clock_.hz()) clock_.change(hz, tick_at(now));
}

std::uint64_t Cluster::next_tick() const {
  if (!powered() || faulted_core_ >= 0 || stopped_) return kNoTick;
  return scheduler_.next_tick();
}

Picoseconds Cluster::next() const {
  const auto tick = next_tick();
  return tick == kNoTick ? kNever : clock_.time_of(tick);
}

void Cluster::advance(Picoseconds until, Picoseconds last, std::uint64_t cycle_limit) {
  const auto end = until == kNever ? kNoTick : tick_at(until);
  const auto stop = std::min(end, clock_.first_after(last));
  has_news_ = false;
  auto start = next_tick();
  // An awake core counts one cycle per tick, so no core reaches the limit within `far_from_limit` ticks.
  const auto begin = start;
  const auto far_from_limit = cycle_limit - std::min(longest_cycles() + ClusterScheduler::kFarthestAhead, cycle_limit);
  bool undisturbed = false;
  do {
    start = scheduler_.run_quantum(start, std::max(end, start + 1), undisturbed);
    undisturbed = true;
  } while (start < stop && !has_news_ && (start - begin < far_from_limit || longest_cycles() < cycle_limit));
}

void Cluster::alarm_rings(std::uint64_t tick) {
  peripherals_->advance(tick);
  spread_events(tick);
}

void Cluster::transfers_end(std::uint64_t tick) {
  dma_.advance(tick, *peripherals_);
  spread_events(tick);
  if (scheduler_.awake() == 0) note_asleep(tick);
}

bool Cluster::core_stopped(ClusterCore& core, Stop stop) {
  if (stop == Stop::device) spread_events(core.accessed());
  if (stop == Stop::sleeping) note_asleep(core.tick());
  if (stop != Stop::fault && stop != Stop::watch && stop != Stop::observer) return true;
  has_news_ = true;
  // The other cores still run to the end of the quantum, and may stop at an earlier tick. Only the earliest stop is
  // recorded. Exception: after an observer has ended the run at one core, stops of other cores are ignored.
  const auto time = clock_.time_of(core.tick());
  if (core_stopped_by_observer_ >= 0 || ((faulted_core_ >= 0 || stopped_) && stop_time_ <= time)) return false;
  const auto id = static_cast<std::int32_t>(core.id());
  stop_time_ = time;
  faulted_core_ = stop == Stop::fault ? id : -1;
  stopped_ = stop != Stop::fault;
  core_stopped_by_observer_ = stop == Stop::observer ? id : -1;
  return false;
}

/// Applies the effects of events in `tick`: sets the interrupt lines of the cores, and wakes and starts cores.
void Cluster::spread_events(std::uint64_t tick) {
  scheduler_.set_alarm(peripherals_->next_tick());
  const auto woken = peripherals_->take_woken();
  const auto changed_lines = peripherals_->take_line_changes();
  const auto wake_tick = tick + kWakeLatency;
  for (auto& core : cores_) {
    bool wakes = false;
    if ((changed_lines >> core->id() & 1U) != 0)
      wakes = core->set_interrupts(peripherals_->lines(core->id()), wake_tick);
    if ((woken >> core->id() & 1U) != 0) wakes = core->wake(wake_tick) || wakes;
    if (wakes) note_awake(wake_tick);
  }
  if ((woken | changed_lines) != 0) scheduler_.cores_changed();
  start_cores(tick + 1);
  const bool fabric_woken = (woken >> kFabricController & 1U) != 0;
  const bool raised = peripherals_->interrupt() && !interrupt_;
  if (fabric_woken || peripherals_->interrupt() != interrupt_) has_news_ = true;
  interrupt_ = peripherals_->interrupt();
  fabric_woken_ = fabric_woken_ || fabric_woken;
  if (fabric_woken || raised) fabric_event_time_ = clock_.time_of(tick);
}

void Cluster::note_awake(std::uint64_t tick) {
  if (busy_.runs()) return;
  busy_.begin(clock_.time_of(tick));
  last_asleep_ = 0;
}

/// Records that a core fell asleep in `tick`, or that a transfer ended in `tick`.
void Cluster::note_asleep(std::uint64_t tick) {
  last_asleep_ = std::max(last_asleep_, tick);
  if (busy_.runs() && scheduler_.awake() == 0 && !dma_.busy()) busy_.end(clock_.time_of(last_asleep_));
}

bool Cluster::take_fabric_wake() {
  const bool woken = fabric_woken_;
  fabric_woken_ = false;
  return woken;
}

BusReply Cluster::access(const ClusterAccess& access) {
  MEBOTS_ASSERT(access.who < cores() || access.who == kFabricController);
  MEBOTS_ASSERT(powered(), "devices of a cluster that is off serve no access");
  if (access.who == kFabricController || peripherals_->owns_of_core(access.address)) {
    return access.size == 4 ? peripherals_->access(access) : BusReply{};
  }
  return access_outside(access);
}

std::uint32_t Cluster::interrupt_taken(unsigned core, unsigned line) {
  peripherals_->interrupt_taken(core, line);
  return peripherals_->lines(core);
}

BusReply Cluster::access_outside(const ClusterAccess& access) {
  if (!outside_) return {};
  has_news_ = true;
  fabric_event_time_ = clock_.time_of(access.tick);
  return outside_(access, fabric_event_time_);
}

bool Cluster::owns(std::uint32_t address) const {
  return powered() && peripherals_->owns_of_fabric_controller(address);
}

BusReply Cluster::load(std::uint32_t address, Picoseconds now) {
  const auto tick = tick_at(now);
  const auto reply = access({kFabricController, address, tick});
  spread_events(tick);
  return reply;
}

BusReply Cluster::load_event(std::uint32_t address, Picoseconds now) {
  const auto tick = tick_at(now);
  const auto reply = access({kFabricController, address, tick, nullptr, true});
  spread_events(tick);
  return reply;
}

BusReply Cluster::store(std::uint32_t address, Picoseconds now, std::uint32_t value) {
  const auto tick = tick_at(now);
  const auto reply = access({kFabricController, address, tick, &value});
  spread_events(tick);
  return reply;
}

const Hart& Cluster::hart(unsigned core) const {
  MEBOTS_ASSERT(core < cores_.size());
  return cores_[core]->hart();
}

Hart& Cluster::hart(unsigned core) {
  return cores_[core]->hart();
}

Picoseconds Cluster::core_time(unsigned core) const {
  MEBOTS_ASSERT(core < cores_.size());
  return time_of_core_at(cores_[core]->tick());
}

Picoseconds Cluster::core_time_at(unsigned core, std::uint64_t cycle) const {
  MEBOTS_ASSERT(core < cores_.size());
  return time_of_core_at(cores_[core]->tick_of(cycle));
}

Picoseconds Cluster::reached() const {
  if (!powered()) return powered_.changed_at();
  std::uint64_t tick = 0;
  for (const auto& core : cores_) tick = std::max(tick, core->tick());
  return time_of_core_at(tick);
}

void Cluster::observe(unsigned core, Observer* observer) {
  MEBOTS_ASSERT(core < cores_.size());
  cores_[core]->observe(observer);
}

Counters Cluster::counters() const {
  Counters sum;
  for (const auto& core : cores_) sum += core->hart().counters();
  return sum;
}

std::uint64_t Cluster::longest_cycles() const {
  std::uint64_t longest = 0;
  for (const auto& core : cores_) longest = std::max(longest, core->hart().counters().cycles);
  return longest;
}

void Cluster::visit(state::Visitor& v) {
  v("banks", banks_);
  v("way", soc_port_);
  if (instruction_cache_) v("instruction_cache", *instruction_cache_);
  v("event_unit", *peripherals_);
  v("dma", dma_);
  for (std::size_t i = 0; i < cores_.size(); ++i) v("core[" + std::to_string(i) + "]", *cores_[i]);
  v("clock", clock_);
  v("powered", powered_);
  v("interrupt", interrupt_);
  v("fabric_woken", fabric_woken_);
  v("stopped", stopped_);
  v("faulted_core", faulted_core_);
  scheduler_.visit(v);
  v("fabric_event_time", fabric_event_time_);
  v("busy", busy_);
  v("last_asleep", last_asleep_);
  if (!v.restores()) return;
  core_stopped_by_observer_ = -1;
  scheduler_.set_alarm(peripherals_->next_tick());
  scheduler_.cores_changed();
}

}  // namespace mebots::soc
