// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "hart/fetch.hpp"
#include "hart/interpreter.hpp"
#include "runs/decoded_code.hpp"
#include "runs/flow_log.hpp"
#include "runs/observed_run.hpp"
#include "translate/translator.hpp"

#include <cstdint>
#include <exception>
#include <utility>

namespace mebots::soc {

/// Runs a core in translated code: chooses the blocks to translate, enters and leaves translated code, and handles the
/// exits. If translated code leaves a block before its end, the interpreter finishes the block.
class TranslatedRun {
 public:
  TranslatedRun(Execution& execution, DecodedCode& decoded, Interpreter& interpreter, Fetch& fetch,
                const ObservedRun& observed, const RunLimit& limit)
      : execution_(execution),
        decoded_(decoded),
        interpreter_(interpreter),
        fetch_(fetch),
        observed_(observed),
        limit_(limit),
        flow_log_(execution, decoded) {}

  bool is_on() const { return decoded_.translates; }

  /// Returns the translated code of this block. If the block has just become hot, translates it first. Returns null if
  /// the interpreter must run the block.
  const translate::Entry* entry(std::uint32_t number, const Block& block, std::uint32_t stall);
  /// Runs from this entry on. Returns true if the next block can begin at once. Returns false if the interpreter has
  /// finished a block. The caller must then check whether the run continues.
  bool run(const translate::Entry& entry, std::uint32_t stall);
  /// Prepares a run from the start of this block on, and returns the code of the block. If the block has no code, or if
  /// the interpreter must run it, returns null without effect.
  const std::uint8_t* begin(std::uint32_t number, const Block& block, std::uint32_t stall);
  /// Finishes a block that translated code has left before an instruction without host code.
  void finish_inside(std::uint64_t exit);
  /// Keeps an exception that occurred during a call from translated code. The exception is thrown when translated code
  /// has returned.
  void keep_error(std::exception_ptr error) { error_ = std::move(error); }
  /// Chains blocks: patches the exit of the last run to jump to this block.
  void chain(const Block& block, const translate::Entry& entry, std::uint32_t stall) {
    decoded_.translator->chain_last_exit(block, entry, stall != 0);
  }
  /// If the block at the pc is translated, patches the exit of the last run to jump to that block. Without this
  /// function, an exit at which each run stops because of its limit would never be patched.
  void chain_to_here();
  /// Returns the block at the pc after an exit from translated code; 0 = unknown.
  std::uint32_t next_block() const {
    const auto next = execution_.next_block;
    const bool holds = next != 0 && next_generation_ == decoded_.blocks.generation();
    return holds && decoded_.blocks.block(next).pc == execution_.pc ? next : 0;
  }

  /// True if the last run stopped at the limit in translated code and can resume there.
  bool has_resume_point() const { return execution_.host.resume_point != nullptr; }
  /// Adjusts the resume point after the table of banks has moved by `bytes` bytes to the front.
  void move_resume_point(std::uint64_t bytes) {
    if (has_resume_point()) execution_.host.begin -= bytes;
  }
  /// Runs this hart from its resume point up to this tick, and then the harts that follow it: see
  /// Execution::set_next(). Records steps into other functions without reporting them.
  translate::RunEnd run_round(std::uint64_t limit_tick);
  /// Passes the steps that the last run has recorded to the observer.
  void report_flow() { flow_log_.report(observed_); }
  /// Handles an exit from translated code. Returns true if the next block can begin at once, as run() does.
  bool finish(const translate::Exit& exit);

 private:
  bool may_begin(const Block& block, std::uint32_t stall) const;
  void prepare(std::uint32_t stall);
  const translate::Entry* translate_when_hot(std::uint32_t number, const Block& block);
  void set_budget();
  void resume_interpreter(const translate::Exit& exit);
  void take_float_flags();
  void note_next(std::uint32_t block) {
    execution_.next_block = block;
    next_generation_ = decoded_.blocks.generation();
  }

  Execution& execution_;
  DecodedCode& decoded_;
  Interpreter& interpreter_;
  Fetch& fetch_;
  const ObservedRun& observed_;
  const RunLimit& limit_;
  FlowLog flow_log_;
  std::exception_ptr error_;
  std::uint64_t next_generation_ = 0;  // generation of blocks for which Execution::next_block is valid
};

/// Returns true if the block may start in translated code: all its instructions start before the limit, even if all
/// cache lines must be fetched. Translated code fetches lines when it reaches them. The first instruction's lines must
/// be present if the cache is shared, or if a stall follows.
inline bool TranslatedRun::may_begin(const Block& block, std::uint32_t stall) const {
  if (!is_on() || !observed_.allows_translation()) return false;
  const auto bound = std::uint64_t{decoded_.blocks.fetch_bound(block)} + stall;
  if (decoded_.flow != nullptr && bound >= FlowLog::kLongestRun) return false;
  if (block.line_count != 0 && (limit_.is_loose() || stall != 0) && !decoded_.blocks.begins_present(block))
    return false;
  // If blocks may run past the limit (loose limit), `bound` is ignored. If the stall already reaches the limit,
  // translated code would return at once.
  const auto cycles = execution_.counters.cycles;
  return limit_.admits(cycles, bound) && !limit_.reached_at(cycles + stall);
}

inline const translate::Entry* TranslatedRun::entry(std::uint32_t number, const Block& block, std::uint32_t stall) {
  if (!may_begin(block, stall)) return nullptr;
  if (decoded_.translator != nullptr) [[likely]] {
    if (const auto* known = decoded_.translator->find(number); known != nullptr) return known;
  }
  return translate_when_hot(number, block);
}

/// Counts the stall of the first instruction, and sets the limit of translated code.
inline void TranslatedRun::prepare(std::uint32_t stall) {
  execution_.counters.cycles += stall;
  set_budget();
}

inline const std::uint8_t* TranslatedRun::begin(std::uint32_t number, const Block& block, std::uint32_t stall) {
  const auto* entry = decoded_.translator->find(number);
  if (entry == nullptr || !may_begin(block, stall)) return nullptr;
  prepare(stall);
  return entry->plain;
}

inline void TranslatedRun::finish_inside(std::uint64_t exit) {
  finish(decoded_.translator->exit(exit));
}

inline bool TranslatedRun::run(const translate::Entry& entry, std::uint32_t stall) {
  prepare(stall);
  execution_.set_next(nullptr);
  const auto* exit = decoded_.translator->run(execution_, entry.plain).exit;
  if (exit == nullptr) {  // left after a rare instruction
    if (error_) [[unlikely]]
      std::rethrow_exception(std::exchange(error_, nullptr));
    return false;
  }
  if (decoded_.flow != nullptr) report_flow();
  return finish(*exit);
}

}  // namespace mebots::soc
