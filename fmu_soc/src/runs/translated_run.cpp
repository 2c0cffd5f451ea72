// SPDX-License-Identifier: Apache-2.0
#include "runs/translated_run.hpp"

#include "instructions/float32.hpp"
#include "mebots/assert.hpp"
#include "runs/hart.hpp"

#include <algorithm>
#include <bit>

namespace mebots::soc {
namespace {

/// A block is translated after the interpreter has run it this number of times within an epoch.
constexpr std::uint16_t kHot = 64;
constexpr unsigned kEpochBits =
    26;  // in cycles; a program of a megabyte that is hot everywhere runs 64 times in an epoch
/// Maximum cycles of a run in translated code, whose counts have 32 bits.
constexpr std::uint64_t kLongestRun = std::uint64_t{1} << 30;

/// Resets the counts on which the decision to translate a block is based. If the block is translated, must be called
/// afterwards, because the translator reads `absences`.
void cool(const Block& block) {
  block.heat = 0;
  block.absences = 0;
}

}  // namespace

const translate::Entry* TranslatedRun::translate_when_hot(std::uint32_t number, const Block& block) {
  auto& blocks = decoded_.blocks;
  auto& translator = decoded_.translator;
  if (const auto epoch = static_cast<std::uint32_t>(execution_.counters.cycles >> kEpochBits); epoch != block.epoch) {
    block.epoch = epoch;
    cool(block);
  }
  if (!blocks.is_present(block)) ++block.absences;
  if (++block.heat < kHot) return nullptr;
  const auto first = blocks.instructions(block)->op;
  if (!decoded_.performs_rare() && ends_block(first) && (!translate::has_translation(first) || is_trap(first))) {
    cool(block);  // its translation would only leave
    return nullptr;
  }
  if (translator == nullptr) {
    const auto perform = decoded_.performs_rare() ? Hart::perform : nullptr;
    translator =
        translate::make_translator(blocks, execution_, {decoded_.loose_limit, decoded_.banks, decoded_.flow, perform});
    decoded_.translates = translator != nullptr;
    if (translator == nullptr) return nullptr;
    blocks.set_listener(translator.get());
  }
  const auto& entry = translator->translate(number);
  MEBOTS_ASSERT(entry.plain != nullptr);
  cool(block);
  return &entry;
}

void TranslatedRun::set_budget() {
  auto& host = execution_.host;
  const auto cycles = flow_log_.make_room(limit_.cycles_from(execution_.counters.cycles));
  auto* banks = decoded_.banks;
  if (banks == nullptr) {
    host.begin = std::min(cycles, kLongestRun);
    return;
  }
  host.alone = execution_.ram[0].banks == nullptr;
  const auto* row = host.alone ? banks->unread() : banks->row(execution_.counters.cycles + execution_.host.tick_offset);
  host.begin = reinterpret_cast<std::uintptr_t>(row);
  host.end = host.begin + std::min(cycles, Banks::kLongestRun) * banks->count();
}

bool TranslatedRun::finish(const translate::Exit& exit) {
  if (decoded_.blocks.extensions().has_floats()) take_float_flags();
  auto& e = execution_;
  auto& host = e.host;
  // If at least one instruction ran in translated code, Execution::pipeline is out of date. The pipeline is empty if
  // the last block was entered by a jump. Otherwise its state is in HostState::straight_pipeline.
  if ((host.instructions & 0xffffffffU) != 0) {
    e.pipeline = {};
  }
  e.slow_load = nullptr;
  if (exit.is_reached_straight && host.straight_pipeline != 0)
    e.pipeline = std::bit_cast<Pipeline>(host.straight_pipeline);
  if (exit.resumes) {
    resume_interpreter(exit);
    return false;
  }
  if (!exit.indirect) e.pc = exit.pc;
  if (exit.straight) {
    MEBOTS_ASSERT(exit.at != nullptr && is_block_end(exit.at->op));
    const bool iterates = exit.at->op == Op::loop_end && e.pc != exit.at->pc;
    e.link = iterates ? decoded_.blocks.loop_link(exit.at[1], e.pc) : &exit.at->link;
    note_next(*e.link);
    return true;
  }
  e.jumped = exit.jumped;
  e.link = exit.at != nullptr ? &exit.at->link : nullptr;
  note_next(exit.block);
  return true;
}

/// Adds the flags that the host has raised in translated code to fflags. In MXCSR, the flags have the reverse order.
/// Bit 1 of MXCSR (denormal operand) has no counterpart.
void TranslatedRun::take_float_flags() {
  const auto host = execution_.host.float_control_after;
  const auto flag = [host](unsigned bit, std::uint8_t guest) { return (host >> bit & 1U) != 0 ? guest : 0U; };
  const auto flags = flag(0, float32::kInvalid) | flag(2, float32::kDivideByZero) | flag(3, float32::kOverflow) |
                     flag(4, float32::kUnderflow) | flag(5, float32::kInexact);
  execution_.float_flags |= static_cast<std::uint8_t>(flags);
}

/// Continues a block in the interpreter, at the instruction before which translated code has left the block.
void TranslatedRun::resume_interpreter(const translate::Exit& exit) {
  MEBOTS_ASSERT(exit.at != nullptr && !is_block_end(exit.at->op));
  auto& e = execution_;
  const auto* at = exit.at;
  std::uint32_t stall = 0;
  if (at->index == 0 && is_load(e.pipeline.before.op)) {  // the stall after the load is counted, but not executed yet
    stall = decoded_.blocks.block(decoded_.blocks.known(at->pc)).stall_after(e.pipeline.before);
    e.counters.cycles -= stall;
  }
  const auto* slow_load = e.host.slow_load_when == e.host.instructions ? e.host.slow_load : nullptr;
  interpreter_.resume(at, exit.wait_cycles, stall, slow_load, exit.fetches || !fetch_.is_present(at));
}

void TranslatedRun::chain_to_here() {
  const auto number = decoded_.blocks.known(execution_.pc);
  if (number == 0 || decoded_.translator == nullptr) return;
  const auto& block = decoded_.blocks.block(number);
  if (const auto* entry = decoded_.translator->find(number); entry != nullptr) {
    chain(block, *entry, block.stall_after(execution_.pipeline.before));
  }
}

translate::RunEnd TranslatedRun::run_round(std::uint64_t limit_tick) {
  auto& host = execution_.host;
  host.end = reinterpret_cast<std::uintptr_t>(decoded_.banks->row(limit_tick));
  MEBOTS_ASSERT(host.resume_point != nullptr, "a round begins with a core that has one");
  return decoded_.translator->run(execution_, host.resume_point);
}

}  // namespace mebots::soc
