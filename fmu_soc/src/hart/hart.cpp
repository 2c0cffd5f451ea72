// SPDX-License-Identifier: Apache-2.0
#include "hart/hart.hpp"

#include "hart/csr_numbers.hpp"
#include "hart/observer.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <utility>

namespace mebots::soc {

Hart::Hart(Memory& memory, Bus& bus, std::shared_ptr<DecodedCode> decoded)
    : memory_(memory),
      bus_(bus),
      decoded_(std::move(decoded)),
      cache_(decoded_->blocks),
      csrs_(execution_, cache_, cache_.timing()),
      traps_(execution_, csrs_, cache_),
      data_path_(execution_, memory, bus),
      fetch_(execution_),
      flow_notes_(execution_, *decoded_) {
  execution_.hart = this;
  std::vector<MemoryPort> ports(memory.regions().size());
  for (std::size_t i = 0; i < ports.size(); ++i) ports[i].region = i;
  connect(ports);
}

void Hart::connect(std::span<const MemoryPort> ports) {
  // Translated code holds all of the fast memories but who else is there.
  if (data_path_.connect(ports)) decoded_->drop_translations();
  cache_.set_longest_wait(data_path_.longest_wait());
}

void Hart::reset(std::uint32_t pc) {
  execution_.counters = {};
  execution_.far_accesses = 0;
  restart(pc);
  cache_.clear();
}

void Hart::restart(std::uint32_t pc) {
  execution_.x = {};
  execution_.pc = pc;
  execution_.loops = {};
  csrs_.restart();
  traps_.restart();
  execution_.pipeline = {};
  wake();
  drop_resume_point();
}

Stop Hart::run(std::uint64_t limit) {
  auto& e = execution_;
  if (traps_.fault().happened) return Stop::fault;
  cache_.forget_if_stale();
  if (!stays_awake()) return Stop::sleeping;
  e.link = nullptr;
  e.jumped = false;
  return go_on(limit, false);
}

/// To the limit, or whatever else stops it. `left_translated`: translated code has just been left.
Stop Hart::go_on(std::uint64_t limit, bool left_translated) {
  auto& e = execution_;
  limit = std::min(limit, kAbsent);
  note_unsettled();
  for (;;) {
    if (cache_.forget_if_stale()) [[unlikely]]
      e.link = nullptr;
    if (e.leave != Leave::normal) {
      if (const auto stop = leave(); stop != Stop::limit) return stop;
    }
    std::uint32_t number = 0;
    if (e.jumped) number = land();
    if (e.counters.cycles >= limit) {
      if (left_translated && e.host.resume_point == nullptr) chain_to_here();
      return Stop::limit;
    }
    e.host.resume_point = nullptr;
    if (csrs_.interrupt_ready()) {
      take_interrupt();
      if (traps_.fault().happened) return Stop::fault;
      left_translated = false;
      continue;
    }
    if (wants_all()) [[unlikely]] {
      if (!observer_->before(*this)) return Stop::observer;
      cache_.forget_if_stale();  // a debugger may have changed code, or the pc
      number = 0;
      e.link = nullptr;
      execution_.cut_pc = kNoPc;
    }
    if (number == 0) number = following();
    e.link = nullptr;
    if (number != 0) [[likely]] {
      left_translated = run_block(number, limit, left_translated);
    } else {
      left_translated = false;
      observer_ != nullptr ? step_observed() : step();
    }
  }
}

/// At the start of a run: false while nothing ends the sleep.
bool Hart::stays_awake() {
  if (sleeping_) {
    if (!wakes()) return false;
    wake();
  }
  if (observer_knows_of_sleep_) [[unlikely]] {
    observer_knows_of_sleep_ = false;
    if (observer_ != nullptr) observer_->woke(*this);
  }
  return true;
}

/// The block at the pc, by the link of what led here if it knows. 0: nothing can be fetched there, or only a limit or a
/// return from a trap has led there, and no block begins there otherwise. Limits cut anywhere: blocks from all of these
/// places would fill the cache and, one after the other, get hot. With a loose limit blocks say where a core stops, so
/// they must not depend on what is decoded. A core restored from a state has decoded nothing.
inline std::uint32_t Hart::following() {
  const auto* link = execution_.link;
  const auto next = execution_.next_block;
  if (link == nullptr && next != 0 && next_generation_ == cache_.generation() &&
      cache_.block(next).pc == execution_.pc) {
    return next;
  }
  if (link != nullptr && *link != 0 && cache_.block(*link).pc == execution_.pc) return *link;
  if (link == nullptr && execution_.pc == execution_.cut_pc && !has_loose_limit())
    return cache_.known(execution_.cut_pc);
  return following_block(execution_.link);
}

/// The target of a jump or taken branch, which costs a cycle when it is unaligned.
inline std::uint32_t Hart::land() {
  execution_.jumped = false;
  const auto* link = execution_.link;
  const bool known = link != nullptr && *link != 0 && cache_.block(*link).pc == execution_.pc;
  const auto number = known ? *link : following_block(execution_.link);
  if (number != 0 && cache_.block(number).unaligned) execution_.counters.cycles += kUnalignedTargetExtra;
  return number;
}

/// One instruction, decoded with what the pipeline holds.
void Hart::step() {
  auto& e = execution_;
  const auto* first = cache_.single(e.pc, e.pipeline.two_before, e.pipeline.before);
  if (first == nullptr) {
    std::uint32_t word = 0;
    BlockCache::fetch(memory_, e.pc, word, e.trap_value);
    e.trap_cause = cause::kFetchAccess;
    e.leave = Leave::trap;
    return;
  }
  execution_.cut_pc = first[1].pc;
  execute(first, fetch_.is_cached() ? fetch_.bring(first, e.counters.cycles) : 0);
  e.link = nullptr;
}

/// Runs a block as fits, or only its first instruction. True: translated code did, and begins no other
/// block only because no patch point leads there yet.
inline bool Hart::run_block(std::uint32_t number, std::uint64_t limit, bool left_translated) {
  auto& e = execution_;
  const auto& block = cache_.block(number);
  // What ran before can delay the first instruction if it was a load. A jump soon after it is another matter.
  const bool early_jump = jumps_too_early(block);
  const auto stall = stall_of(block);
  const auto present = cache_.is_present(block) ? 0 : kAbsent;
  const auto bound = ((std::uint64_t{block.last_start_bound} + stall) & bound_mask_) | present | unsettled_;
  const bool may_run = e.counters.cycles + bound < limit;
  const bool at_access = std::exchange(at_access_, false);
  if (!early_jump && !at_access && may_translate(block, stall) && may_begin(block, stall, limit)) {
    // With a loose limit, a stall may reach it; translated code would not begin then.
    const auto* entry = e.counters.cycles + stall < limit ? translated(number, block) : nullptr;
    if (entry != nullptr) {
      if (left_translated) decoded_->translator->chain_last_exit(block.pc, *entry, stall != 0);
      e.counters.cycles += stall;
      return run_translated(*entry, limit);
    }
  }
  if (observer_ != nullptr) [[unlikely]] {
    run_block_observed(block, stall, limit, early_jump);
    return false;
  }
  if (early_jump || !may_run) [[unlikely]] {
    if (early_jump || bound < kAbsent || !fetch_and_execute(block, stall, limit)) step();
    note_unsettled();
  } else if (translation_on_) {
    execute(cache_.instructions(block), 0, stall);
  } else {
    interpret(block, stall, limit);
  }
  return false;
}

/// Whether translated code may begin a block: no instruction of it can start too late, whatever must be fetched for it.
/// It asks for its lines when it gets there, but for those of the first instruction where others use the cache, or
/// where a stall comes behind them.
inline bool Hart::may_begin(const Block& block, std::uint32_t stall, std::uint64_t limit) const {
  if (unsettled_ != 0) return false;
  if (block.line_count != 0 && (has_loose_limit() || stall != 0) && !cache_.begins_present(block)) return false;
  const auto bound = std::uint64_t{block.fetch_bound} + stall;
  return execution_.counters.cycles + (bound & bound_mask_) < limit;
}

/// A block, and behind it what follows by links without anything to decide.
inline void Hart::interpret(const Block& block, std::uint32_t stall, std::uint64_t limit) {
  auto& e = execution_;
  execute(cache_.instructions(block), 0, stall);
  // Only the limit and the lines are to be checked.
  while (e.link != nullptr && *e.link != 0 && e.leave == Leave::normal && !csrs_.interrupt_ready() &&
         !cache_.is_stale()) {
    const auto& next = cache_.block(*e.link);
    if (next.pc != e.pc || !cache_.is_present(next)) return;
    if (jumps_too_early(next)) return;
    const auto cycles = e.counters.cycles + (e.jumped && next.unaligned ? kUnalignedTargetExtra : 0U);
    const auto next_stall = stall_of(next);
    if (cycles + ((std::uint64_t{next.last_start_bound} + next_stall) & bound_mask_) >= limit) return;
    e.counters.cycles = cycles;
    e.jumped = false;
    e.link = nullptr;
    execute(cache_.instructions(next), 0, next_stall);
  }
}

/// What a block was left for other than the next one. Stop::limit: the core goes on.
Stop Hart::leave() {
  auto& e = execution_;
  const auto why = std::exchange(e.leave, Leave::normal);
  switch (why) {
    case Leave::trap:
      if (e.trap_cause == cause::kBreakpoint && bus_.called_host()) {
        set_pc(e.pc + 4);
        return Stop::device;
      }
      if (traps_.take_exception()) entered_handler();
      return traps_.fault().happened ? Stop::fault : Stop::limit;
    case Leave::device:
      return Stop::device;
    case Leave::stop:
      return Stop::watch;
    case Leave::turn:
      at_access_ = true;
      return Stop::turn;
    case Leave::event:
    case Leave::sleep:
      waits_for_event_ = why == Leave::event;
      if (!wakes()) {
        sleeping_ = true;
        if (observer_ != nullptr) observer_->slept(*this);
        observer_knows_of_sleep_ = observer_ != nullptr;
        return Stop::sleeping;
      }
      waits_for_event_ = false;
      return Stop::limit;
    case Leave::normal:
      break;
  }
  return Stop::limit;
}

/// The block at the pc, noted in the link of the instruction that led here when there is one.
std::uint32_t Hart::following_block(std::uint32_t* link) {
  const auto generation = cache_.generation();
  const auto number = cache_.find(execution_.pc);
  if (link != nullptr && cache_.generation() == generation) *link = number;
  return number;
}

/// Code for a block, once it is hot.
inline const translate::Entry* Hart::translated(std::uint32_t number, const Block& block) {
  auto& translator = decoded_->translator;
  if (translator != nullptr) [[likely]] {
    if (const auto* entry = translator->find(number); entry != nullptr) return entry;
  }
  return translate_when_hot(number, block);
}

void Hart::execute(const Instruction* first, std::uint32_t extra_cycles, std::uint32_t stall,
                   const Instruction* slow_load) {
  execution_.begin_block(extra_cycles, stall, slow_load);
  for (const auto* at = first; at != nullptr;) at = at->run(execution_, at);
  execution_.finish_block();
}

/// A debugger moves the pc: what the pipeline held is gone.
void Hart::set_pc(std::uint32_t pc) {
  execution_.pc = pc & ~1U;
  execution_.link = nullptr;
  execution_.jumped = false;
  execution_.pipeline = {};
  drop_resume_point();
}

/// Behind Traps::enter_handler: the pc is at the handler.
void Hart::entered_handler() {
  if (observer_ != nullptr) observer_->trapped(*this, csrs_.last_trap());
  execution_.counters.cycles += kTrapEntryCycles;
}

void Hart::take_interrupt() {
  const auto number = traps_.next_interrupt();
  if (traps_.enter_handler(cause::kInterrupt | number, 0)) entered_handler();
  if (csrs_.has_event_unit()) bus_.interrupt_taken(number);
}

const Instruction* Hart::set_loop_end(const Instruction* at, unsigned loop, std::uint32_t pc) {
  execution_.loops[loop].end = pc;
  return cache_.end_block_at(pc) ? execution_.leave_after(at, Leave::normal) : at + 1;
}

void Hart::visit(state::Visitor& v) {
  MEBOTS_ASSERT(execution_.x[0] == 0, "writes to x0 go to the last one");
  auto registers = execution_.x;
  registers.back() = 0;  // what was written to x0 is nothing
  v("x", std::span(registers).first<32>());
  v("pc", execution_.pc);
  v("loops", execution_.loops);
  v("far_accesses", execution_.far_accesses);
  v("csr", csrs_);
  v("counters", execution_.counters);
  v("traps", traps_);
  v("pipeline", execution_.pipeline);
  v("sleeping", sleeping_);
  v("waits_for_event", waits_for_event_);
  if (!v.restores()) return;
  execution_.x = registers;
  execution_.cut_pc = kNoPc;
  observer_knows_of_sleep_ = observer_ != nullptr && sleeping_;
  drop_resume_point();
  cache_.clear();
  for (const auto& loop : execution_.loops) cache_.end_block_at(loop.end);  // for a hart restored without its memory
}

}  // namespace mebots::soc
