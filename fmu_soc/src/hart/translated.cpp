// SPDX-License-Identifier: Apache-2.0
//
// Into translated code and back: what it is told, what it leaves to do, the round-robin of harts in it.
#include "hart/hart.hpp"

#include <algorithm>
#include <bit>

namespace mebots::soc {
namespace {

/// A block is translated when it was interpreted this often in one epoch: what runs now and then, for however long, is
/// not worth it.
constexpr std::uint16_t kHot = 64;
constexpr unsigned kEpochBits = 26;  // of cycles: a program of a megabyte, all of it hot, runs 64 times in one
/// Most cycles of one stay in translated code: its counts have 32 bits.
constexpr std::uint64_t kLongestRun = std::uint64_t{1} << 30;

}  // namespace

void Hart::set_translation(bool on) {
  translation_on_ = on;
  decoded_->drop_translations();
}

const translate::Entry* Hart::translate_when_hot(std::uint32_t number, const Block& block) {
  auto& translator = decoded_->translator;
  if (const auto epoch = static_cast<std::uint32_t>(execution_.counters.cycles >> kEpochBits); epoch != block.epoch) {
    block.epoch = epoch;
    block.heat = 0;
  }
  if (++block.heat < kHot) return nullptr;
  block.heat = 0;
  const auto first = cache_.instructions(block)->op;
  if (ends_block(first) && !is_jump(first) && !is_hardware_loop(first)) return nullptr;  // nothing to gain
  if (translator == nullptr) {
    translator = translate::make_translator(cache_, execution_, {has_loose_limit(), decoded_->banks, decoded_->flow});
    translation_on_ = translator != nullptr;
    if (!translation_on_) return nullptr;
    cache_.set_listener(translator.get());
  }
  return &translator->translate(number);
}

/// True: the next block begins; false: the interpreter has finished one, and may have something to say.
bool Hart::run_translated(const translate::Entry& entry, std::uint64_t limit) {
  set_budget(limit);
  execution_.host.next = nullptr;
  const auto& exit = *decoded_->translator->run(execution_, entry.plain).exit;
  if (decoded_->flow != nullptr) flow_notes_.tell(*this, observer_);
  return finish_translated(exit);
}

/// Tells translated code how far it may go.
void Hart::set_budget(std::uint64_t limit) {
  auto& host = execution_.host;
  const auto cycles = flow_notes_.make_room(limit - execution_.counters.cycles);
  auto* banks = decoded_->banks;
  if (banks == nullptr) {
    host.begin = std::min(cycles, kLongestRun);
    return;
  }
  host.alone = execution_.ram[0].banks == nullptr;
  const auto* row = host.alone ? banks->unread() : banks->row(execution_.counters.cycles + execution_.host.tick_offset);
  host.begin = reinterpret_cast<std::uintptr_t>(row);
  host.end = host.begin + std::min(cycles, Banks::kLongestRun) * banks->count();
}

/// What translated code leaves to do; as run_translated.
bool Hart::finish_translated(const translate::Exit& exit) {
  auto& e = execution_;
  auto& host = e.host;
  // What came before the block that was left, or that begins: nothing when another block led there by a jump.
  if ((host.instructions & 0xffffffffU) != (exit.straight ? exit.at->index : 0U)) {
    e.pipeline = {};
  }
  e.slow_load = nullptr;
  if (exit.is_reached_straight && host.came_from != 0) e.pipeline = std::bit_cast<Pipeline>(host.came_from);
  if (exit.resumes) {
    std::uint32_t stall = 0;
    if (exit.at->index == 0) {  // counted already, but it has not begun
      stall = stall_of(cache_.block(block_of(exit.at)));
      e.counters.cycles -= stall;
    }
    const auto* slow_load = host.slow_load_when == host.instructions ? host.slow_load : nullptr;
    if (exit.fetches || !fetch_.is_present(exit.at)) {
      resume_fetching(exit.at, exit.wait_cycles, stall, slow_load);
    } else if (observer_ != nullptr) {
      execute_observed(exit.at, exit.wait_cycles, stall, slow_load);
    } else {
      execute(exit.at, exit.wait_cycles, stall, slow_load);
    }
    return false;
  }
  if (!exit.indirect) e.pc = exit.pc;
  if (exit.straight) {
    e.remember(exit.at);
    const bool iterates = exit.at->op == Op::loop_end && e.pc != exit.at->pc;
    e.link = iterates ? loop_link(exit.at[1], e.pc) : &exit.at->link;
    note_next(*e.link);
    return true;
  }
  e.jumped = exit.jumped;
  e.link = exit.at != nullptr ? &exit.at->link : nullptr;
  note_next(exit.block);
  return true;
}

/// Translated code was left at the limit: its patch point can lead on all the same, if there is code where it leads.
/// Where a block is as long as the time between two limits, nothing else would ever chain it.
void Hart::chain_to_here() {
  const auto number = cache_.known(execution_.pc);
  if (number == 0 || !translates()) return;
  const auto& block = cache_.block(number);
  if (jumps_too_early(block)) return;
  if (const auto* entry = decoded_->translator->find(number); entry != nullptr) {
    decoded_->translator->chain_last_exit(block.pc, *entry, stall_of(block) != 0);
  }
}

Hart::RoundEnd Hart::run_round_robin(Hart& first, std::uint64_t limit_tick) {
  auto& decoded = *first.decoded_;
  auto& host = first.execution_.host;
  host.end = reinterpret_cast<std::uintptr_t>(decoded.banks->row(limit_tick));
  const auto [exit, execution] = decoded.translator->run(first.execution_, host.resume_point);
  if (decoded.flow != nullptr) {
    for (auto* e = &first.execution_; e != nullptr; e = e->host.next)
      e->hart->flow_notes_.tell(*e->hart, e->hart->observer_);
  }
  if (execution == nullptr) return {};
  auto& hart = *execution->hart;
  if (exit == nullptr) return {&hart};
  const bool begins = hart.finish_translated(*exit);
  return {&hart, true, hart.go_on(limit_tick - hart.execution_.host.tick_offset, begins)};
}

}  // namespace mebots::soc
