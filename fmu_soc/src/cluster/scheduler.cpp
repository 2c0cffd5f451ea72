// SPDX-License-Identifier: Apache-2.0
#include "cluster/scheduler.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <bit>

namespace mebots::soc {

ClusterScheduler::ClusterScheduler(const ClusterSettings& settings, DecodedCode& code, Banks& way, ClusterDma& dma,
                                   ClusterEvents& events)
    : settings_(settings), code_(code), banks_(*code.banks), soc_port_(way), dma_(dma), events_(events) {
  MEBOTS_ASSERT(settings.quantum > 0 && settings.quantum <= Banks::kLongestRun);
  cores_.reserve(settings.cores);
  queue_.reserve(settings.cores);
  if (code_.instruction_cache != nullptr) code_.instruction_cache->set_alone(!sharing_banks_);
}

void ClusterScheduler::add(ClusterCore& core) {
  MEBOTS_ASSERT(core.id() == cores_.size() && cores_.size() < kMostClusterCores);
  cores_.push_back(&core);
}

void ClusterScheduler::cores_changed() {
  awake_ = 0;
  for (const auto* core : cores_) awake_ += core->sleeps() ? 0U : 1U;
  in_step_ = false;
}

void ClusterScheduler::drop_resume_points() {
  in_step_ = false;
  for (auto* core : cores_) core->hart().drop_resume_point();
}

std::uint64_t ClusterScheduler::next_tick() const {
  return std::min({dma_.next_tick(), alarm_, first_ready()});
}

/// Returns the earliest tick in which a core continues, or kNoTick if all cores sleep.
std::uint64_t ClusterScheduler::first_ready() const {
  auto first = kNoTick;
  // The loop has no branch, because the host could not predict a branch here.
  for (const auto* core : cores_) first = std::min(first, core->ready());
  return first;
}

ClusterCore& ClusterScheduler::core_at(std::uint64_t ready) {
  const auto is_there = [ready](const ClusterCore* core) { return core->ready() == ready; };
  return **std::find_if(cores_.begin(), cores_.end(), is_there);
}

std::uint64_t ClusterScheduler::run_quantum(std::uint64_t start, std::uint64_t until, bool undisturbed) {
  MEBOTS_ASSERT(start < until);
  MEBOTS_ASSERT(first_core_ < cores());
  goes_on_ = true;
  if (code_.instruction_cache != nullptr) code_.instruction_cache->settle(start);
  if (undisturbed && in_step_ && awake_ > 1 && !dma_.busy() && alarm_ == kNoTick) {
    return run_quantum_in_step(start, until);
  }
  while (alarm_ <= start) ring();
  share_banks();
  if (sharing_banks_ && start > banks_.start()) {
    dma_.occupy(banks_, start);  // claims the beats that were due while all cores slept
    move_banks(start);
  }
  auto end = std::min(start + (sharing_banks_ ? settings_.quantum : kLongQuantum), until);
  end = std::min(end, alarm_);
  if (dma_first_) dma_.occupy(banks_, end);
  line_up(end);
  in_step_ = false;
  end_ = end;
  run_queue(0, end);
  next_in_front();
  return finish_quantum(end);
}

/// Does the same as run_quantum() in less time. Only the cores' ticks may have changed since the previous quantum: all
/// awake cores have ended it in translated code, and no other event is due.
std::uint64_t ClusterScheduler::run_quantum_in_step(std::uint64_t start, std::uint64_t until) {
  MEBOTS_ASSERT(sharing_banks_ && start > banks_.start());
  move_banks(start);
  const auto end = std::min(start + settings_.quantum, until);
  end_ = end;
  line_up(end);
  next_in_front();
  const auto round = Hart::run_round_robin(queue_.front()->hart(), end);
  if (round.broke_off == nullptr) return keep_in_step();
  in_step_ = false;
  run_queue(note_round(0, round), end);
  return finish_quantum(end);
}

/// Runs cores, registers and DMA in the order of their ticks up to `end`. Returns the start of the next quantum.
std::uint64_t ClusterScheduler::finish_quantum(std::uint64_t end) {
  while (goes_on_) {
    if (!sharing_banks_) {
      share_banks();
      if (sharing_banks_) {  // the only awake core has woken other cores or started a transfer
        const auto now = next_tick();
        end = std::min(end, now + settings_.quantum);
        move_banks(std::max(banks_.start(), now));
        end_ = end;
      }
    }
    dma_.occupy(banks_, end);
    const auto first = first_ready();
    const auto transfer = dma_.next_tick();
    if (alarm_ < end && alarm_ <= std::min(first, transfer)) {
      ring();
      continue;
    }
    if (transfer < end && transfer <= first) {
      events_.transfers_end(transfer);
      continue;
    }
    if (first >= end) return std::min({transfer, alarm_, first});
    in_step_ = false;
    auto& core = core_at(first);
    // A core may have changed the tick of the registers' next event in this quantum.
    const auto stop = std::min(end, alarm_);
    MEBOTS_ASSERT(core.tick() < stop);
    core.grant_turn();
    run_core(core, stop);
  }
  return kNoTick;
}

bool ClusterScheduler::permits_at_once(std::uint64_t tick) {
  if (awake_ != 1 || tick >= std::min(alarm_, end_)) return false;
  // As in finish_quantum(), the DMA first claims its banks, because conflicts may delay the end of a transfer.
  dma_.occupy(banks_, end_);
  return tick < dma_.next_tick();
}

/// Handles the event of the cluster's registers that is due now.
void ClusterScheduler::ring() {
  const auto tick = alarm_;
  events_.alarm_rings(tick);
  MEBOTS_ASSERT(alarm_ > tick, "an alarm rings once per tick");
}

/// Determines whether bank conflicts in L1 are possible. If the DMA is idle and at most one core is awake, they are
/// not.
void ClusterScheduler::share_banks() {
  const bool several = awake_ > 1 || dma_.busy();
  if (several == sharing_banks_) return;
  sharing_banks_ = several;
  for (auto* core : cores_) core->share_banks(several);
  if (code_.instruction_cache != nullptr) code_.instruction_cache->set_alone(!several);
  drop_resume_points();
}

void ClusterScheduler::move_banks(std::uint64_t tick) {
  if (!banks_.must_start_over(tick)) {
    banks_.move_to(tick);
    if (settings_.shares_soc_port) soc_port_.move_to(tick);
    return;
  }
  // No bank is claimed after `last`: the DMA has claimed banks at most up to the end of the last quantum, and each core
  // at most up to its present tick.
  auto last = tick + settings_.quantum;
  for (const auto* core : cores_) last = std::max(last, core->tick());
  const auto moved = banks_.start_over(tick, last);
  for (auto* core : cores_) core->hart().move_resume_point(moved);
  if (settings_.shares_soc_port) soc_port_.start_over(tick, last + ClusterLatencies::kMostAccessTicks);
}

/// Selects the first core of the next quantum, and whether the DMA claims banks before or after the cores. Both change
/// in every quantum. Exception: with the arbitration tree and an even number of cores, the DMA keeps its place when
/// core 0 becomes the first core. Without this exception, the DMA would always have the same place in the quanta in
/// which a given core is first.
void ClusterScheduler::next_in_front() {
  if (++first_core_ == cores()) first_core_ = 0;
  const bool stays = settings_.arbitration_tree && first_core_ == 0 && cores() % 2 == 0;
  dma_first_ = dma_first_ != !stays;
}

/// Builds the queue of a quantum that ends at `end`. Reuses the queue of the last quantum if it contains the same
/// cores.
void ClusterScheduler::line_up(std::uint64_t end) {
  const bool same = in_step_ && queue_.size() == awake_ && last_ready_ < end;
  if (same && !settings_.arbitration_tree) {
    rotate_queue();
  } else if (same && awake_ == cores() && std::has_single_bit(cores())) {
    reorder_queue();
  } else {
    queue_cores(end);
  }
}

/// Queues the cores that continue before `end` and do not wait for permission to access a shared device, starting with
/// the first core of this quantum. Links each core to the next one.
void ClusterScheduler::queue_cores(std::uint64_t end) {
  queue_.clear();
  const bool tree = settings_.arbitration_tree;
  const auto places = tree ? std::bit_ceil(cores()) : cores();
  for (std::uint32_t place = 0; place < places; ++place) {
    auto id = tree ? place ^ first_core_ : place + first_core_;
    if (id >= cores()) {
      if (tree) continue;  // the tree has more places than there are cores
      id -= cores();
    }
    auto& core = *cores_[id];
    if (core.ready() >= end || core.waits_for_turn()) continue;
    if (!queue_.empty()) queue_.back()->hart().set_next(&core.hart());
    queue_.push_back(&core);
  }
  if (!queue_.empty()) queue_.back()->hart().set_next(nullptr);
}

/// Changes the queue of the last quantum into that of this quantum: moves the core that was first to the end.
void ClusterScheduler::rotate_queue() {
  const auto before = (first_core_ == 0 ? cores() : first_core_) - 1;
  if (queue_.front()->id() != before) return;  // the core that was first sleeps and is not in the queue
  queue_.back()->hart().set_next(&queue_.front()->hart());
  std::rotate(queue_.begin(), queue_.begin() + 1, queue_.end());
  queue_.back()->hart().set_next(nullptr);
}

/// Orders the queue of this quantum by the arbitration tree: see ClusterSettings::arbitration_tree. All cores must be
/// awake.
void ClusterScheduler::reorder_queue() {
  Hart* behind = nullptr;
  for (auto place = cores(); place-- > 0;) {
    auto& core = *cores_[place ^ first_core_];
    core.hart().set_next(behind);
    behind = &core.hart();
    queue_[place] = &core;
  }
}

/// Runs the cores of the queue from index `place` on, up to tick `end`.
void ClusterScheduler::run_queue(std::size_t place, std::uint64_t end) {
  while (place < queue_.size()) {
    auto& core = *queue_[place];
    if (!can_resume(core)) {
      run_core(core, end);
      ++place;
      continue;
    }
    const auto round = Hart::run_round_robin(core.hart(), end);
    if (place == 0 && round.broke_off == nullptr) {
      keep_in_step();
      return;
    }
    place = note_round(place, round);
  }
}

/// Returns true if this core can run in translated code from its resume point on, followed by the next cores.
bool ClusterScheduler::can_resume(const ClusterCore& core) {
  if (!sharing_banks_ || !core.hart().has_resume_point()) return false;
  code_.blocks.forget_if_stale();
  if (version_ == code_.version()) return true;
  version_ = code_.version();
  drop_resume_points();
  return false;
}

/// Handles the end of a round. In a round, cores run to the end of the quantum in translated code, one after the other,
/// until one of them leaves translated code. The round began at index `place` of the queue. Returns the index at which
/// the next round begins.
std::size_t ClusterScheduler::note_round(std::size_t place, const Hart::RoundEnd& round) {
  while (place < queue_.size() && &queue_[place]->hart() != round.broke_off) ++place;
  if (round.ran) note_stop(*queue_[place++], round.stop);
  return place;
}

void ClusterScheduler::run_core(ClusterCore& core, std::uint64_t end) {
  note_stop(core, core.run(end));
}

void ClusterScheduler::note_stop(ClusterCore& core, Stop stop) {
  core.stopped(stop);
  if (stop == Stop::limit || stop == Stop::turn) return;
  if (stop == Stop::sleeping) cores_changed();
  if (!events_.core_stopped(core, stop)) goes_on_ = false;
}

/// Called if all cores of the queue ended the quantum in translated code, so that only their ticks have changed.
/// Returns the tick in which the first core continues.
std::uint64_t ClusterScheduler::keep_in_step() {
  last_ready_ = 0;
  auto first = kNoTick;
  for (const auto* core : queue_) {
    const auto ready = core->tick();
    last_ready_ = std::max(last_ready_, ready);
    first = std::min(first, ready);
  }
  in_step_ = true;
  if (queue_.size() == awake_) return first;
  // All other awake cores have already passed the end of this quantum, or wait for permission.
  for (const auto* core : cores_) {
    if (core->sleeps()) continue;
    in_step_ = in_step_ && core->can_resume();
    last_ready_ = std::max(last_ready_, core->tick());
    first = std::min(first, core->tick());
  }
  return first;
}

void ClusterScheduler::visit(state::Visitor& v) {
  v("first_core", first_core_);
  v("dma_first", dma_first_);
}

}  // namespace mebots::soc
