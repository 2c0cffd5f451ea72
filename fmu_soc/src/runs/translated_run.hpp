// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "hart/fetch.hpp"
#include "hart/interpreter.hpp"
#include "runs/decoded_code.hpp"
#include "runs/flow_notes.hpp"
#include "runs/observed_run.hpp"
#include "translate/translator.hpp"

#include <cstdint>

namespace mebots::soc {

/// Runs a core in translated code: which blocks get some, into it and back, and what it leaves to do. Where a block was
/// left in its middle, the interpreter finishes it.
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
        flow_notes_(execution, decoded) {}

  /// Whether hot code is translated.
  bool is_on() const { return decoded_.translates; }

  /// Code that may begin this block now; null = the interpreter runs it. A block gets code when it is hot.
  const translate::Entry* entry(std::uint32_t number, const Block& block, std::uint32_t stall);
  /// From this entry on. True: the next block begins, and nothing else is to be done; false: the interpreter has
  /// finished one, and may have something to say.
  bool run(const translate::Entry& entry, std::uint32_t stall);
  /// Block chaining: the patch point by which the last run was left leads to this block from now on.
  void chain(const Block& block, const translate::Entry& entry, std::uint32_t stall) {
    decoded_.translator->chain_last_exit(block, entry, stall != 0);
  }
  /// Likewise to the block at the pc, if there is code for it. It was left at the limit: where a block is as long as
  /// the time between two limits, nothing else would ever chain it.
  void chain_to_here();
  /// The block at the pc, where translated code was left for it; 0 = not known.
  std::uint32_t next_block() const {
    const auto next = execution_.next_block;
    const bool holds = next != 0 && next_generation_ == decoded_.blocks.generation();
    return holds && decoded_.blocks.block(next).pc == execution_.pc ? next : 0;
  }

  /// Whether the last run stopped at the limit in translated code, where it only has to go on.
  bool has_resume_point() const { return execution_.host.resume_point != nullptr; }
  /// The rows of the banks' table stand so many bytes further to the front.
  void move_resume_point(std::uint64_t bytes) {
    if (has_resume_point()) execution_.host.begin -= bytes;
  }
  /// From the resume point up to this tick, and so the next ones of the round. Steps between functions are noted, and
  /// not told yet.
  translate::RunEnd run_round(std::uint64_t limit_tick);
  /// Tells the observer the steps between functions that the last run noted.
  void tell_flow() { flow_notes_.tell(observed_); }
  /// What translated code leaves to do; as `run`.
  bool finish(const translate::Exit& exit);

 private:
  bool may_begin(const Block& block, std::uint32_t stall) const;
  const translate::Entry* translate_when_hot(std::uint32_t number, const Block& block);
  void set_budget();
  void resume_interpreter(const translate::Exit& exit);
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
  FlowNotes flow_notes_;
  std::uint64_t next_generation_ = 0;  // of blocks, in which Execution::next_block is meant
};

/// Whether no instruction of the block can start too late, whatever must be fetched for it. Translated code asks for
/// its lines when it gets there, but for those of the first instruction where others use the cache, or where a stall
/// comes behind them.
inline bool TranslatedRun::may_begin(const Block& block, std::uint32_t stall) const {
  if (!is_on() || !observed_.allows_translation()) return false;
  const auto bound = std::uint64_t{decoded_.blocks.fetch_bound(block)} + stall;
  if (decoded_.flow != nullptr && bound >= FlowNotes::kLongestRun) return false;
  if (block.line_count != 0 && (limit_.is_loose() || stall != 0) && !decoded_.blocks.begins_present(block))
    return false;
  // With a loose limit, a stall may reach it; translated code would not begin then.
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

inline bool TranslatedRun::run(const translate::Entry& entry, std::uint32_t stall) {
  execution_.counters.cycles += stall;
  set_budget();
  execution_.set_next(nullptr);
  const auto& exit = *decoded_.translator->run(execution_, entry.plain).exit;
  if (decoded_.flow != nullptr) tell_flow();
  return finish(exit);
}

}  // namespace mebots::soc
