// SPDX-License-Identifier: Apache-2.0
#include "cluster/cluster.hpp"

#include "cluster/core.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <bit>

namespace mebots::soc {
namespace {

/// The way to the SoC is taken no longer by one access, however slow the SoC's clock is.
constexpr std::uint32_t kMostAccessTicks = 512;

}  // namespace

Cluster::Cluster(Memory& memory, const ClusterSettings& settings, const InstructionEnergy& energy)
    : settings_(settings),
      instruction_cache_(make_instruction_cache(settings.instruction_cache, InstructionCache::Users::several)),
      banks_(settings.l1_banks),
      decoded_(memory, {.timing = settings.timing,
                        .energy = energy,
                        .loose_limit = true,
                        .instruction_cache = instruction_cache_.get(),
                        .banks = &banks_}),
      dma_(memory, settings.l1_region, settings.dma),
      peripherals_(settings.make_peripherals(dma_)) {
  MEBOTS_ASSERT(settings.cores > 0 && settings.cores <= kMostClusterCores);
  MEBOTS_ASSERT(settings.quantum > 0 && settings.quantum <= Banks::kLongestRun);
  ready_.fill(kNoTick);
  queue_.reserve(settings.cores);
  for (unsigned id = 0; id < settings.cores; ++id) {
    cores_.push_back(std::make_unique<Core>(*this, id, memory));
  }
  clock_.reset(settings.clock_hz);
}

Cluster::~Cluster() = default;

void Cluster::power_on(Picoseconds now, std::uint32_t boot) {
  if (powered()) return;
  powered_.begin(now);
  in_step_ = false;
  peripherals_->reset(boot);
  alarm_ = peripherals_->next_tick();
  dma_.reset();
  banks_.free_all();  // nothing of what cores had claimed ahead of time when they were switched off
  way_.free_all();
  if (instruction_cache_) instruction_cache_->flush();
  for (auto& core : cores_) core->halt();
  start_cores(tick_at(now));
}

void Cluster::start_cores(std::uint64_t tick) {
  const auto started = peripherals_->take_started();
  if (started != 0) in_step_ = false;
  for (auto& core : cores_) {
    if ((started >> core->id() & 1U) != 0) core->start(peripherals_->boot_address(core->id()), tick);
  }
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

void Cluster::set_ways(const ClusterWays& ways) {
  MEBOTS_ASSERT(ways.waits.size() == settings_.ports.size());
  for (std::size_t i = 0; i < ways.waits.size(); ++i) settings_.ports[i].wait_cycles = ways.waits[i];
  dma_.set_timing(ways.dma);
  if (instruction_cache_) instruction_cache_->set_refill_cycles(ways.refill_cycles);
  for (auto& core : cores_) core->connect(std::clamp(ways.access_ticks, 1U, kMostAccessTicks));
  drop_resume_points();
}

void Cluster::set_clock(Picoseconds now, std::uint32_t hz) {
  MEBOTS_ASSERT(hz > 0);
  if (hz != clock_.hz()) clock_.change(hz, tick_at(now));
}

std::uint64_t Cluster::next_tick() const {
  if (!powered() || faulted_core_ >= 0 || stopped_) return kNoTick;
  return std::min({dma_.next_tick(), alarm_, first_ready()});
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
  bool goes_on_in_step = false;  // nothing has come between
  do {
    const auto most = std::max(end, start + 1);
    goes_on_in_step = goes_on_in_step && awake_ > 1 && !dma_.busy() && alarm_ == kNoTick;
    start = goes_on_in_step ? run_quantum_in_step(start, most) : run_quantum(start, most);
    goes_on_in_step = in_step_;
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
  for (auto& core : cores_) core->hart().translated().drop_resume_point();
}

void Cluster::move_banks(std::uint64_t tick) {
  if (!banks_.must_start_over(tick)) {
    banks_.move_to(tick);
    if (settings_.shares_way) way_.move_to(tick);
    return;
  }
  // The DMA takes nothing behind the last quantum's end, and no core anything behind where it stands.
  auto last = tick + settings_.quantum;
  for (const auto& core : cores_) last = std::max(last, core->tick());
  const auto moved = banks_.start_over(tick, last);
  for (auto& core : cores_) core->hart().translated().move_resume_point(moved);
  if (settings_.shares_way) way_.start_over(tick, last + kMostAccessTicks);
}

/// The answer is when the next one starts.
std::uint64_t Cluster::run_quantum(std::uint64_t start, std::uint64_t until) {
  MEBOTS_ASSERT(start < until);
  MEBOTS_ASSERT(first_core_ < cores());
  while (alarm_ <= start) ring(alarm_);
  share_banks();
  if (sharing_banks_ && start > banks_.start()) {
    dma_.occupy(banks_, start);  // what it moved while all slept
    move_banks(start);
  }
  auto end = std::min(start + (sharing_banks_ ? settings_.quantum : kLongQuantum), until);
  end = std::min(end, alarm_);
  if (dma_first_) dma_.occupy(banks_, end);
  run_cores(start, end);
  next_in_front();
  return finish_quantum(end);
}

/// Behind the quantum just begun the next core and the other of DMA and cores come first. With the tree the DMA's side
/// stays once where an even count of cores begins anew, so that each core that is first meets the DMA on either side.
void Cluster::next_in_front() {
  if (++first_core_ == cores()) first_core_ = 0;
  const bool stays = settings_.arbitration_tree && first_core_ == 0 && cores() % 2 == 0;
  dma_first_ = dma_first_ != !stays;
}

/// As run_quantum, right behind one in which all cores that are awake have stayed in translated code, with nothing else
/// to happen. Only their ticks have changed, and the table of banks goes on.
std::uint64_t Cluster::run_quantum_in_step(std::uint64_t start, std::uint64_t until) {
  MEBOTS_ASSERT(sharing_banks_ && start > banks_.start());
  move_banks(start);
  const auto end = std::min(start + settings_.quantum, until);
  line_up(end);
  next_in_front();
  const auto round = Hart::run_round_robin(queue_.front()->hart(), end);
  if (round.broke_off == nullptr) return keep_in_step();
  in_step_ = false;
  run_queue(note_round(0, round), start, end);
  return finish_quantum(end);
}

/// What no core does without asking, in the order of its ticks. The answer is when the next quantum starts.
std::uint64_t Cluster::finish_quantum(std::uint64_t end) {
  while (faulted_core_ < 0 && !stopped_) {
    if (!sharing_banks_) {
      share_banks();
      if (sharing_banks_) {  // the only core has woken others, or started a transfer
        const auto now = next_tick();
        end = std::min(end, now + settings_.quantum);
        move_banks(std::max(banks_.start(), now));
      }
    }
    dma_.occupy(banks_, end);
    const auto first = first_ready();
    const auto transfer = dma_.next_tick();
    if (alarm_ < end && alarm_ <= std::min(first, transfer)) {
      ring(alarm_);
      continue;
    }
    if (transfer < end && transfer <= first) {
      dma_.advance(transfer, *peripherals_);
      spread_events(transfer);
      if (awake_ == 0) note_asleep(transfer);
      continue;
    }
    if (first >= end) return std::min({transfer, alarm_, first});
    in_step_ = false;
    auto& core = *cores_[static_cast<std::size_t>(std::find(ready_.begin(), ready_.end(), first) - ready_.begin())];
    // A core may have set the alarm in this very quantum.
    const auto stop = std::min(end, alarm_);
    MEBOTS_ASSERT(core.tick() < stop);
    core.grant_turn();
    run_core(core, stop);
  }
  return kNoTick;
}

/// Something happens in the registers by itself.
void Cluster::ring(std::uint64_t tick) {
  peripherals_->advance(tick);
  spread_events(tick);
  MEBOTS_ASSERT(alarm_ > tick, "it happens once in a tick");
}

/// The cores that run without asking, from the first one of this quantum on, each linked to the next one.
void Cluster::queue_cores(std::uint64_t end) {
  queue_.clear();
  const bool tree = settings_.arbitration_tree;
  const auto places = tree ? std::bit_ceil(cores()) : cores();
  for (std::uint32_t place = 0; place < places; ++place) {
    auto id = tree ? place ^ first_core_ : place + first_core_;
    if (id >= cores()) {
      if (tree) continue;  // a leaf without a core
      id -= cores();
    }
    auto& core = *cores_[id];
    if (ready_[id] >= end || core.waits_for_turn()) continue;
    if (!queue_.empty()) queue_.back()->hart().translated().set_next(&core.hart().translated());
    queue_.push_back(&core);
  }
  if (!queue_.empty()) queue_.back()->hart().translated().set_next(nullptr);
}

/// The same cores as in the quantum before, each one place further to the front if the first one goes to the end.
void Cluster::rotate_queue() {
  const auto before = (first_core_ == 0 ? cores() : first_core_) - 1;
  if (queue_.front()->id() != before) return;  // who sleeps has no place
  queue_.back()->hart().translated().set_next(&queue_.front()->hart().translated());
  std::rotate(queue_.begin(), queue_.begin() + 1, queue_.end());
  queue_.back()->hart().translated().set_next(nullptr);
}

/// All cores, of which each leaf of the tree has one, in the order of this quantum.
void Cluster::reorder_queue() {
  TranslatedRun* behind = nullptr;
  for (auto place = cores(); place-- > 0;) {
    auto& core = *cores_[place ^ first_core_];
    core.hart().translated().set_next(behind);
    behind = &core.hart().translated();
    queue_[place] = &core;
  }
}

/// The queue of a quantum up to `end`, made of that of the one before if it holds the same cores.
void Cluster::line_up(std::uint64_t end) {
  const bool same = in_step_ && queue_.size() == awake_ && last_ready_ < end;
  if (same && !settings_.arbitration_tree) {
    rotate_queue();
  } else if (same && awake_ == cores() && std::has_single_bit(cores())) {
    reorder_queue();
  } else {
    queue_cores(end);
  }
}

/// Every core that may run without asking, up to `end`.
void Cluster::run_cores(std::uint64_t start, std::uint64_t end) {
  line_up(end);
  in_step_ = false;
  run_queue(0, start, end);
}

/// The queue from its place `i` on.
void Cluster::run_queue(std::size_t i, std::uint64_t start, std::uint64_t end) {
  while (i < queue_.size()) {
    if (!can_resume(queue_[i]->hart(), start)) {
      run_core(*queue_[i++], end);
      continue;
    }
    const auto round = Hart::run_round_robin(queue_[i]->hart(), end);
    if (i == 0 && round.broke_off == nullptr) {
      keep_in_step();
      return;
    }
    i = note_round(i, round);
  }
}

/// What a round from place `i` on has done; the answer is the place behind.
std::size_t Cluster::note_round(std::size_t i, const Hart::RoundEnd& round) {
  while (i < queue_.size() && &queue_[i]->hart() != round.broke_off) queue_[i++]->stopped(Stop::limit);
  if (round.ran) note_stop(*queue_[i++], round.stop);
  return i;
}

/// All cores of the queue have come to the end of the quantum in translated code: nothing but their ticks has changed.
/// The answer is when the first core goes on.
std::uint64_t Cluster::keep_in_step() {
  last_ready_ = 0;
  auto first = kNoTick;
  for (auto* core : queue_) {
    core->stopped(Stop::limit);
    const auto ready = ready_[core->id()];
    last_ready_ = std::max(last_ready_, ready);
    first = std::min(first, ready);
  }
  in_step_ = true;
  if (queue_.size() == awake_) return first;
  // The others had come beyond this quantum in the one before, or wait for something.
  for (const auto& core : cores_) {
    if (core->sleeps()) continue;
    in_step_ = in_step_ && core->can_resume();
    last_ready_ = std::max(last_ready_, ready_[core->id()]);
    first = std::min(first, ready_[core->id()]);
  }
  return first;
}

/// Whether the hart, and who comes behind it, may run a round from `start` on.
bool Cluster::can_resume(const Hart& hart, std::uint64_t start) {
  if (!sharing_banks_ || !hart.translated().has_resume_point()) return false;
  if (instruction_cache_ && start < instruction_cache_->settled()) return false;
  decoded_.blocks.forget_if_stale();
  if (version_ == decoded_.version()) return true;
  version_ = decoded_.version();
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
  if (stop != Stop::fault && stop != Stop::watch && stop != Stop::observer) return;
  has_news_ = true;
  // The others go on to the end of the quantum, and may stop in it, too: before this one in time, if not in turn. An
  // observer that has ended the run at one core lets no other go on, wherever that stands.
  const auto time = clock_.time_of(core.tick());
  if (core_stopped_by_observer_ >= 0 || ((faulted_core_ >= 0 || stopped_) && stop_time_ <= time)) return;
  const auto id = static_cast<std::int32_t>(core.id());
  stop_time_ = time;
  faulted_core_ = stop == Stop::fault ? id : -1;
  stopped_ = stop != Stop::fault;
  core_stopped_by_observer_ = stop == Stop::observer ? id : -1;
}

/// What happened in `tick` wakes who waited for it, and starts who was to begin.
void Cluster::spread_events(std::uint64_t tick) {
  alarm_ = peripherals_->next_tick();
  const auto woken = peripherals_->take_woken();
  const auto changed_lines = peripherals_->take_line_changes();
  if ((woken | changed_lines) != 0) in_step_ = false;  // a core may have an interrupt to take
  for (auto& core : cores_) {
    if ((changed_lines >> core->id() & 1U) != 0) core->set_interrupts(peripherals_->lines(core->id()), tick);
    if ((woken >> core->id() & 1U) != 0) core->wake(tick + kWakeLatency);
  }
  start_cores(tick + 1);
  const bool fabric_woken = (woken >> kFabricController & 1U) != 0;
  const bool raised = peripherals_->interrupt() && !interrupt_;
  if (fabric_woken || peripherals_->interrupt() != interrupt_) has_news_ = true;
  interrupt_ = peripherals_->interrupt();
  fabric_woken_ = fabric_woken_ || fabric_woken;
  if (fabric_woken || raised) fabric_event_time_ = clock_.time_of(tick);
}

/// A core is awake from `tick` on.
void Cluster::note_awake(std::uint64_t tick) {
  if (busy_.runs()) return;
  busy_.begin(clock_.time_of(tick));
  last_asleep_ = 0;
}

/// A core fell asleep in `tick`, or a transfer ended in it.
void Cluster::note_asleep(std::uint64_t tick) {
  last_asleep_ = std::max(last_asleep_, tick);
  if (busy_.runs() && awake_ == 0 && !dma_.busy()) busy_.end(clock_.time_of(last_asleep_));
}

bool Cluster::take_fabric_wake() {
  const bool woken = fabric_woken_;
  fabric_woken_ = false;
  return woken;
}

BusReply Cluster::access(const ClusterAccess& access) {
  MEBOTS_ASSERT(access.who < cores() || access.who == kFabricController);
  MEBOTS_ASSERT(powered(), "devices of a cluster that is off belong to nobody");
  if (access.who == kFabricController || peripherals_->owns_of_core(access.address)) {
    return access.size == 4 ? peripherals_->access(access) : BusReply{};
  }
  return access_outside(access);
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
  v("way", way_);
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
  v("first_core", first_core_);
  v("dma_first", dma_first_);
  v("fabric_event_time", fabric_event_time_);
  v("busy", busy_);
  v("last_asleep", last_asleep_);
  if (!v.restores()) return;
  core_stopped_by_observer_ = -1;
  in_step_ = false;
  alarm_ = peripherals_->next_tick();
}

}  // namespace mebots::soc
