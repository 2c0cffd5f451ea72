// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/instruction.hpp"
#include "hart/timing.hpp"
#include "mebots/assert.hpp"
#include "memory/banks.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

class Hart;
class BlockCache;
class Csrs;
class DataPath;
class Fetch;
class Traps;

/// A piece of RAM as the inner loop sees it.
struct FastRegion {
  std::uint32_t base = 0;
  std::uint32_t span = 0;  // size - 3; 0 = no region
  std::uint8_t* data = nullptr;
  std::uint8_t* marks = nullptr;
  std::uint32_t wait_cycles = 0;  // added to every access: the way there and back
  BankSchedule* banks = nullptr;  // who else uses it; null = nobody

  bool is_shared() const { return banks != nullptr; }
};

/// Why a block was left other than by a branch or at its end.
enum class Leave : std::uint8_t { normal, trap, device, stop, sleep, event, turn };

/// Registers of a hardware loop. The body runs once more after its last instruction while the count is above 1.
struct HardwareLoop {
  std::uint32_t start = 0;
  std::uint32_t end = 0;  // address of the last instruction of the body
  std::uint32_t count = 0;

  void visit(state::Visitor& v) {
    v("start", start);
    v("end", end);
    v("count", count);
  }
};

/// Counters since reset that nothing in the core can write.
struct Counters {
  std::uint64_t instructions = 0;     // retired
  std::uint64_t cycles = 0;           // active, sleep not counted
  std::uint64_t instruction_fj = 0;   // energy of instructions at the reference voltage
  std::uint64_t accesses = 0;         // loads and stores, all together
  std::uint64_t device_accesses = 0;  // of these: to devices
  std::uint64_t far_accesses = 0;     // of these: to memories other than the first
  std::uint64_t fetch_cycles = 0;     // of the cycles: waiting for the instruction cache

  /// Loads and stores to the first memory.
  std::uint64_t near_accesses() const { return accesses - device_accesses - far_accesses; }
  Counters& operator+=(const Counters& other) {
    instructions += other.instructions;
    cycles += other.cycles;
    instruction_fj += other.instruction_fj;
    accesses += other.accesses;
    device_accesses += other.device_accesses;
    far_accesses += other.far_accesses;
    fetch_cycles += other.fetch_cycles;
    return *this;
  }
  void visit(state::Visitor& v) {
    v("instructions", instructions);
    v("cycles", cycles);
    v("instruction_fj", instruction_fj);
    v("accesses", accesses);
    v("device_accesses", device_accesses);
    v("far_accesses", far_accesses);
    v("fetch_cycles", fetch_cycles);
  }
};

/// The last two instructions in the pipeline.
struct Pipeline {
  Previous before;
  Previous two_before;

  bool operator==(const Pipeline&) const = default;
  void visit(state::Visitor& v) {
    v("before", before);
    v("two_before", two_before);
  }
};

struct Execution;

inline constexpr const std::uint8_t* kNoResumePoint = nullptr;

/// Data exchanged with translated code.
struct HostState {
  /// Where its count of cycles starts and ends. From those that may start down to 0, or where banks are shared, from
  /// one row of their table to another.
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  /// Where to go on when it was left only for the end of its budget, and nothing has happened since; else null.
  const std::uint8_t* resume_point = nullptr;
  /// Of the next hart of the round, which goes on then without leaving translated code; null = none. And where its
  /// resume point stands, or a null one: what the host needs first, for a jump that it cannot foresee.
  Execution* next = nullptr;
  const std::uint8_t* const* resume_point_of_next = &kNoResumePoint;
  std::uint64_t instructions = 0;  // of the last run; upper half: loads and stores
  /// What the pipeline holds for a region's block that was reached straight from the end of another one, as bits of a
  /// Pipeline; 0 = nothing came straight.
  std::uint64_t straight_pipeline = 0;
  const Instruction* slow_load = nullptr;  // the last load across two words
  std::uint64_t slow_load_when = 0;        // what `instructions` was then: of its block if they still are
  std::uint64_t tick_offset = 0;           // active cycle c is tick c + offset of what the hart shares
  bool alone = false;                      // nobody else uses the banks: what is taken in the table means nothing
  // Where steps between functions are noted:
  Flow* flow = nullptr;              // the next one
  std::uint64_t position = 0;        // where the count of cycles stood at the end of the last run
  std::uint64_t instruction_fj = 0;  // of it
};

/// Marks the absence of a pc, which is never odd.
inline constexpr std::uint32_t kNoPc = 1;

/// The units of a core that handlers use in addition to Execution. See runs/core.md.
struct HartUnits {
  Csrs& csrs;
  Traps& traps;
  DataPath& data_path;
  Fetch& fetch;
  BlockCache& blocks;
};

/// The state of a core that its handlers and translated code change, and the block in progress. During a block, the
/// counters and the pipeline are those of its start.
struct Execution {
  std::array<std::uint32_t, 33> x{};  // x[0] stays 0; x[32] takes what is written to x0
  std::uint32_t pc = 0;
  std::array<HardwareLoop, 2> loops{};  // 0 is the inner one
  FastRegion ram[2];
  Counters counters;
  Pipeline pipeline;

  // Of the block in progress.
  std::uint32_t extra_cycles = 0;          // beyond the static ones
  std::uint32_t first_stall = 0;           // of them: stall of the first instruction after a load
  const Instruction* exit = nullptr;       // everything before it has retired
  std::uint32_t* link = nullptr;           // slot for the number of the next block
  std::uint32_t next_block = 0;            // where translated code stopped; 0 = unknown
  bool jumped = false;                     // an unaligned target costs a cycle
  bool redirected = false;                 // left by a branch, jump, trap or return from one
  const Instruction* slow_load = nullptr;  // the last misaligned load
  const Instruction* waits_at = nullptr;   // the next instruction, if its line is absent or an observer is set
  Leave leave = Leave::normal;
  std::uint32_t trap_cause = 0;
  std::uint32_t trap_value = 0;
  std::uint32_t cut_pc = kNoPc;      // after a cut block, after a single instruction, or at the return of a trap
  const HartUnits* units = nullptr;  // of the same core
  Hart* hart = nullptr;              // its hart
  HostState host;

  /// The next hart of the round, or null.
  void set_next(Execution* next) {
    host.next = next;
    host.resume_point_of_next = next == nullptr ? &kNoResumePoint : &next->host.resume_point;
  }
  /// The next instruction of a run must begin in the interpreter.
  void drop_resume_point() { host.resume_point = nullptr; }

  // The block in progress. Functions that leave it return null, which the handler returns, too.

  /// `stall`: of its first instruction after a load.
  void begin_block(std::uint32_t cycles, std::uint32_t stall, const Instruction* slow_load_before) {
    extra_cycles = cycles + stall;
    first_stall = stall;
    redirected = false;
    slow_load = slow_load_before;
  }
  /// Resumes a block after its first instruction. The instructions before are already counted, so the counters are set
  /// back to the block's start. The time must not be read until the block is finished.
  void begin_block_inside(const Instruction* at);
  std::uint32_t stalled_before(const Instruction* at) const { return at->index == 0 ? first_stall : 0U; }
  /// Returns the active cycle in which an instruction starts.
  std::uint64_t cycle_of(const Instruction* at) const { return counters.cycles + at->cycles_before + extra_cycles; }
  /// The same for devices and counters. A stall after a load counts from the instruction's start on. An instruction
  /// that is left before it has any effect has not stalled yet.
  std::uint64_t start_of(const Instruction* at) const { return cycle_of(at) - stalled_before(at); }
  const Instruction* leave_after(const Instruction* at, Leave why);
  const Instruction* leave_before(const Instruction* at, Leave why);
  /// Leaves the block before an instruction that raises an exception.
  const Instruction* raise(const Instruction* at, std::uint32_t cause, std::uint32_t value);
  /// Counts the instructions retired before `exit`.
  void count_up_to(const Instruction& last) {
    counters.instructions += last.index;
    counters.cycles += last.cycles_before + extra_cycles;
    counters.instruction_fj += last.energy_before_fj;
    counters.accesses += last.accesses_before;
  }
  /// Counts all instructions of the block, and updates the pipeline.
  void finish_block();
  /// Stores the last two instructions before `last` of a block that continues straight on.
  void remember(const Instruction* last);
};

inline void Execution::begin_block_inside(const Instruction* at) {
  MEBOTS_ASSERT(counters.instructions >= at->index && counters.cycles >= at->cycles_before);
  MEBOTS_ASSERT(counters.accesses >= at->accesses_before);
  counters.instructions -= at->index;
  counters.cycles -= at->cycles_before;
  counters.instruction_fj -= at->energy_before_fj;
  counters.accesses -= at->accesses_before;
  if (at->index == 1) pipeline.before = pipeline.two_before;  // what came before the block: see remember()
  begin_block(0, 0, nullptr);
}

inline void Execution::finish_block() {
  MEBOTS_ASSERT(exit != nullptr);
  MEBOTS_ASSERT(x[0] == 0, "writes to x0 go to the last one");
  count_up_to(*exit);
  if (redirected) {
    pipeline = {};
  } else {
    remember(exit);
  }
}

inline void Execution::remember(const Instruction* last) {
  if (last->index == 0) return;
  pipeline.two_before = one_later(last->index >= 2 ? executed(last[-2], false) : pipeline.before);
  pipeline.before = executed(last[-1], slow_load == last - 1);
}

}  // namespace mebots::soc
