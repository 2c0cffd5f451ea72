// SPDX-License-Identifier: Apache-2.0
#include "cluster/cluster.hpp"

#include "cluster/core.hpp"
#include "fmu_soc_board/board.hpp"
#include "mebots/assert.hpp"

#include <algorithm>

namespace mebots::soc {
namespace {

template <std::size_t Count>
constexpr std::uint32_t size_of(const std::array<board::RegisterName, Count>& registers) {
  return registers.back().offset + 4;
}

}  // namespace

Cluster::Cluster(Memory& memory, const ClusterSettings& settings, const InstructionEnergy& energy)
    : settings_(settings),
      decoded_(std::make_shared<DecodedCode>(memory, settings.timing, energy, &banks_)),
      instruction_cache_(settings.instruction_cache.size == 0
                             ? std::nullopt
                             : std::optional<InstructionCache>(settings.instruction_cache)),
      banks_(settings.l1_banks),
      event_unit_(settings.cores),
      dma_(memory, settings.l1_region, settings.dma) {
  MEBOTS_ASSERT(settings.cores > 0 && settings.cores <= kMostClusterCores);
  ready_.fill(kNoTick);
  queue_.reserve(settings.cores);
  for (unsigned id = 0; id < settings.cores; ++id) {
    cores_.push_back(std::make_unique<Core>(*this, id, memory, decoded_));
  }
  clock_.reset(settings.clock_hz);
}

Cluster::~Cluster() = default;

void Cluster::power_on(Picoseconds now, std::uint32_t boot) {
  if (powered_) return;
  powered_ = true;
  powered_since_ = now;
  in_step_ = false;
  event_unit_ = EventUnit(cores());
  dma_.reset();
  banks_.free_all();  // nothing of what cores had claimed ahead of time when they were switched off
  if (instruction_cache_) instruction_cache_->flush();
  const auto tick = tick_at(now);
  for (auto& core : cores_) core->start(boot, tick);
}

void Cluster::power_off(Picoseconds now) {
  if (!powered_) return;
  powered_ = false;
  powered_total_ += now - powered_since_;
  MEBOTS_ASSERT(powered_total_ >= 0 && now >= powered_since_, "time does not go back");
  for (auto& core : cores_) core->stop();
  interrupt_ = false;
  fabric_woken_ = false;
}

void Cluster::set_clock(Picoseconds now, std::uint32_t hz) {
  MEBOTS_ASSERT(hz > 0);
  if (hz != clock_.hz()) clock_.change(hz, tick_at(now));
}

std::uint64_t Cluster::next_tick() const {
  if (!powered_ || faulted_core_ >= 0 || stopped_) return kNoTick;
  return std::min(dma_.next_tick(), first_ready());
}

Picoseconds Cluster::next() const {
  const auto tick = next_tick();
  return tick == kNoTick ? kNever : clock_.time_of(tick);
}

/// When the core that is farthest behind goes on; kNoTick while all sleep.
std::uint64_t Cluster::first_ready() const {
  auto first = kNoTick;
  for (const auto tick : ready_) first = std::min(first, tick);  // no branch: which one it is cannot be predicted
  return first;
}

void Cluster::advance(Picoseconds until, Picoseconds last, std::uint64_t cycle_limit) {
  const auto end = until == kNever ? kNoTick : tick_at(until);
  const auto stop = std::min(end, clock_.first_after(last));
  has_news_ = false;
  auto start = next_tick();
  // Awake, a core counts a cycle a tick: the limit is not near before so many ticks have passed.
  const auto begin = start;
  const auto far_from_limit = cycle_limit - std::min(longest_cycles() + kFarthestAhead, cycle_limit);
  do {
    start = run_quantum(start, std::max(end, start + 1));
  } while (start < stop && !has_news_ && (start - begin < far_from_limit || longest_cycles() < cycle_limit));
}

/// Whether somebody can find a bank of L1 taken: alone, a core finds all of them free.
void Cluster::share_banks() {
  const bool several = awake_ > 1 || dma_.busy();
  if (several == sharing_banks_) return;
  sharing_banks_ = several;
  for (auto& core : cores_) core->share_banks(several);
  drop_resume_points();
}

/// Every core begins its next run in the interpreter.
void Cluster::drop_resume_points() {
  in_step_ = false;
  for (auto& core : cores_) core->hart().drop_resume_point();
}

void Cluster::move_banks(std::uint64_t tick) {
  if (!banks_.must_start_over(tick)) {
    banks_.move_to(tick);
    return;
  }
  // The DMA takes nothing behind the last quantum's end, and no core anything behind where it stands.
  auto last = tick + kQuantum;
  for (const auto& core : cores_) last = std::max(last, core->tick());
  banks_.start_over(tick, last);
  drop_resume_points();
}

/// The answer is when the next one starts.
std::uint64_t Cluster::run_quantum(std::uint64_t start, std::uint64_t until) {
  MEBOTS_ASSERT(start < until);
  MEBOTS_ASSERT(first_core_ < cores());
  share_banks();
  if (sharing_banks_ && start > banks_.start()) {
    dma_.occupy(banks_, start);  // what it moved while all slept
    move_banks(start);
  }
  auto end = std::min(start + (sharing_banks_ ? kQuantum : kLongQuantum), until);
  if (dma_first_) dma_.occupy(banks_, end);
  run_cores(start, end);
  if (++first_core_ == cores()) first_core_ = 0;
  dma_first_ = !dma_first_;
  while (faulted_core_ < 0 && !stopped_) {
    if (!sharing_banks_) {
      share_banks();
      if (sharing_banks_) {  // the only core has woken others, or started a transfer
        const auto now = next_tick();
        end = std::min(end, now + kQuantum);
        move_banks(std::max(banks_.start(), now));
      }
    }
    dma_.occupy(banks_, end);
    const auto first = first_ready();
    const auto transfer = dma_.next_tick();
    if (transfer < end && transfer <= first) {
      dma_.advance(transfer, event_unit_);
      spread_events(transfer);
      continue;
    }
    if (first >= end) return std::min(transfer, first);
    in_step_ = false;
    auto& core = *cores_[static_cast<std::size_t>(std::find(ready_.begin(), ready_.end(), first) - ready_.begin())];
    MEBOTS_ASSERT(core.tick() < end);
    core.grant_turn();
    run_core(core, end);
  }
  return kNoTick;
}

/// The cores that run without asking, from the first one of this quantum on, each linked to the next one.
void Cluster::queue_cores(std::uint64_t end) {
  queue_.clear();
  auto next = first_core_;
  for (std::uint32_t i = 0; i < cores(); ++i) {
    auto& core = *cores_[next];
    if (ready_[next] < end && !core.waits_for_turn()) {
      if (!queue_.empty()) queue_.back()->hart().set_next(&core.hart());
      queue_.push_back(&core);
    }
    if (++next == cores()) next = 0;
  }
  if (!queue_.empty()) queue_.back()->hart().set_next(nullptr);
}

/// The same cores as in the quantum before, each one place further to the front if the first one goes to the end.
void Cluster::rotate_queue() {
  const auto before = (first_core_ == 0 ? cores() : first_core_) - 1;
  if (queue_.front()->id() != before) return;  // who sleeps has no place
  queue_.back()->hart().set_next(&queue_.front()->hart());
  std::rotate(queue_.begin(), queue_.begin() + 1, queue_.end());
  queue_.back()->hart().set_next(nullptr);
}

/// Every core that may run without asking, up to `end`.
void Cluster::run_cores(std::uint64_t start, std::uint64_t end) {
  if (in_step_ && last_ready_ < end) {
    rotate_queue();
  } else {
    queue_cores(end);
  }
  in_step_ = false;
  for (std::size_t i = 0; i < queue_.size();) {
    if (!can_resume(queue_[i]->hart(), start)) {
      run_core(*queue_[i++], end);
      continue;
    }
    const auto round = Hart::run_round_robin(queue_[i]->hart(), end);
    if (i == 0 && round.broke_off == nullptr) {
      keep_in_step();
      return;
    }
    while (i < queue_.size() && &queue_[i]->hart() != round.broke_off) queue_[i++]->stopped(Stop::limit);
    if (round.ran) note_stop(*queue_[i++], round.stop);
  }
}

/// All cores of the queue have come to the end of the quantum in translated code: nothing but their ticks has changed.
void Cluster::keep_in_step() {
  last_ready_ = 0;
  for (auto* core : queue_) {
    core->stopped(Stop::limit);
    last_ready_ = std::max(last_ready_, ready_[core->id()]);
  }
  in_step_ = queue_.size() == awake_;
}

/// Whether the hart, and who comes behind it, may run a round from `start` on.
bool Cluster::can_resume(const Hart& hart, std::uint64_t start) {
  if (!sharing_banks_ || !hart.has_resume_point()) return false;
  if (instruction_cache_ && start < instruction_cache_->settled()) return false;
  decoded_->blocks.forget_if_stale();
  if (version_ == decoded_->version()) return true;
  version_ = decoded_->version();
  drop_resume_points();
  return false;
}

void Cluster::run_core(Core& core, std::uint64_t end) {
  note_stop(core, core.run(end));
}

void Cluster::note_stop(Core& core, Stop stop) {
  MEBOTS_ASSERT(core.id() < cores_.size() && cores_[core.id()].get() == &core);
  core.stopped(stop);
  if (stop == Stop::device) spread_events(core.accessed());
  if (stop == Stop::fault) faulted_core_ = static_cast<std::int32_t>(core.id());
  if (stop == Stop::watch || stop == Stop::observer) stopped_ = true;
  if (stop == Stop::observer) core_stopped_by_observer_ = static_cast<std::int32_t>(core.id());
  if (stop == Stop::fault || stopped_) has_news_ = true;
}

/// What happened in `tick` wakes who waited for it.
void Cluster::spread_events(std::uint64_t tick) {
  const auto woken = event_unit_.take_woken();
  if (woken != 0) in_step_ = false;
  for (auto& core : cores_) {
    if ((woken >> core->id() & 1U) != 0) core->wake(tick + kWakeLatency);
  }
  const bool fabric_woken = (woken >> kFabricController & 1U) != 0;
  const bool raised = event_unit_.interrupt() && !interrupt_;
  if (fabric_woken || event_unit_.interrupt() != interrupt_) has_news_ = true;
  interrupt_ = event_unit_.interrupt();
  fabric_woken_ = fabric_woken_ || fabric_woken;
  if (fabric_woken || raised) fabric_event_time_ = clock_.time_of(tick);
}

bool Cluster::take_fabric_wake() {
  const bool woken = fabric_woken_;
  fabric_woken_ = false;
  return woken;
}

BusReply Cluster::access(unsigned who, std::uint32_t address, std::uint64_t tick, const std::uint32_t* stored,
                         bool event) {
  MEBOTS_ASSERT(who < cores() || who == kFabricController);
  MEBOTS_ASSERT(powered_, "devices of a cluster that is off belong to nobody");
  if (const auto offset = address - settings_.event_unit_base; offset < size_of(board::event_unit::kRegisters)) {
    if (stored == nullptr) return event ? event_unit_.load_event(who, offset) : event_unit_.load(who, offset);
    return event_unit_.store(who, offset, *stored) ? BusReply::done() : BusReply{};
  }
  if (const auto offset = address - settings_.dma_base; offset < size_of(board::cluster_dma::kRegisters)) {
    if (stored == nullptr) return dma_.load(who, offset);
    return dma_.store(who, offset, *stored, tick) ? BusReply::done() : BusReply{};
  }
  return {};
}

bool Cluster::owns(std::uint32_t address) const {
  return powered_ && (address - settings_.event_unit_base < size_of(board::event_unit::kRegisters) ||
                      address - settings_.dma_base < size_of(board::cluster_dma::kRegisters));
}

BusReply Cluster::load(std::uint32_t address, Picoseconds now) {
  return access(kFabricController, address, tick_at(now), nullptr, false);
}

BusReply Cluster::load_event(std::uint32_t address, Picoseconds now) {
  const auto tick = tick_at(now);
  const auto reply = access(kFabricController, address, tick, nullptr, true);
  spread_events(tick);
  return reply;
}

BusReply Cluster::store(std::uint32_t address, Picoseconds now, std::uint32_t value) {
  const auto tick = tick_at(now);
  const auto reply = access(kFabricController, address, tick, &value, false);
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
  return clock_.time_of(cores_[core]->tick());
}

void Cluster::observe(unsigned core, Observer* observer) {
  MEBOTS_ASSERT(core < cores_.size());
  cores_[core]->observe(observer);
}

Counters Cluster::counters() const {
  Counters sum;
  for (const auto& core : cores_) {
    const auto& counters = core->hart().counters();
    sum.instructions += counters.instructions;
    sum.cycles += counters.cycles;
    sum.instruction_fj += counters.instruction_fj;
    sum.accesses += counters.accesses;
    sum.device_accesses += counters.device_accesses;
    sum.fetch_cycles += counters.fetch_cycles;
  }
  return sum;
}

std::uint64_t Cluster::far_accesses() const {
  std::uint64_t sum = 0;
  for (const auto& core : cores_) sum += core->hart().far_accesses();
  return sum;
}

std::uint64_t Cluster::longest_cycles() const {
  std::uint64_t longest = 0;
  for (const auto& core : cores_) longest = std::max(longest, core->hart().counters().cycles);
  return longest;
}

void Cluster::visit(state::Visitor& v) {
  v("banks", banks_);
  if (instruction_cache_) v("instruction_cache", *instruction_cache_);
  v("event_unit", event_unit_);
  v("dma", dma_);
  for (std::size_t i = 0; i < cores_.size(); ++i) v("core[" + std::to_string(i) + "]", *cores_[i]);
  v("clock", clock_);
  v("powered", powered_);
  v("interrupt", interrupt_);
  v("fabric_woken", fabric_woken_);
  v("stopped", stopped_);
  v("faulted_core", faulted_core_);
  v("first_core", first_core_);
  v("dma_first", dma_first_);
  v("fabric_event_time", fabric_event_time_);
  v("powered_since", powered_since_);
  v("powered_total", powered_total_);
  if (!v.restores()) return;
  core_stopped_by_observer_ = -1;
  in_step_ = false;
}

}  // namespace mebots::soc
