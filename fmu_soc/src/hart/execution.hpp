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
struct CsrState;
class DataPath;
class Fetch;
class Traps;

/// A range of RAM for the fast path of loads and stores.
struct FastRegion {
  std::uint32_t base = 0;
  std::uint32_t span = 0;  // size - 3; 0 = no region
  std::uint8_t* data = nullptr;
  std::uint8_t* marks = nullptr;
  std::uint32_t wait_cycles = 0;  // added to every access: latency in both directions
  BankSchedule* banks = nullptr;  // banks shared with other users; null = no other user

  bool is_shared() const { return banks != nullptr; }
};

/// The reason for which execution left a block. `normal` means that the hart continues at the next instruction without
/// further action. `stopped` means that the hart has already determined its reason to stop.
enum class Leave : std::uint8_t { normal, trap, device, stop, sleep, event, turn, counting, stopped };

/// Registers of a hardware loop. If the count is above 1 after the last instruction of the body, the body runs again.
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

/// The word that lr.w has reserved, and its value at that time. sc.w fails if the value has changed since then.
struct Reservation {
  bool valid = false;
  std::uint32_t address = 0;
  std::uint32_t value = 0;

  void visit(state::Visitor& v) {
    v("valid", valid);
    v("address", address);
    v("value", value);
  }
};

/// Counters since reset. Programs cannot write these counters.
struct Counters {
  std::uint64_t instructions = 0;     // retired
  std::uint64_t cycles = 0;           // active, sleep not counted
  std::uint64_t instruction_fj = 0;   // energy of instructions at the reference voltage
  std::uint64_t accesses = 0;         // loads and stores
  std::uint64_t device_accesses = 0;  // of these, to devices
  std::uint64_t far_accesses = 0;     // of these, to memories other than the first
  std::uint64_t fetch_cycles = 0;     // of the cycles, waits for the instruction cache

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

/// Counts of RI5CY's events by their number in PCER. Events 0 (cycles) and 1 (instructions) always stay 0 here, because
/// `Counters` has their counts.
inline constexpr std::size_t kEventCounters = 17;
using EventCounts = std::array<std::uint64_t, kEventCounters>;

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

/// Value of MXCSR without flags: rounds to nearest, masks all exceptions, and flushes no number to zero.
inline constexpr std::uint32_t kFloatControl = 0x1f80;

/// Data that the interpreter and translated code exchange.
struct HostState {
  /// First and last value of the register with which translated code counts cycles. If banks are not shared, the
  /// register contains the number of remaining cycles, and decreases to 0. If banks are shared, the register contains
  /// an address in the table of banks, and advances by one row per cycle.
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  /// Address at which translated code resumes after it stopped at its limit. Null if translated code cannot resume at
  /// its limit, or if the hart's state has changed after the stop.
  const std::uint8_t* resume_point = nullptr;
  /// The next hart of the round; null = none. Translated code continues with that hart without a return to the caller.
  /// `resume_point_of_next` is the address of that hart's `resume_point`, or of a null pointer. Translated code loads
  /// `resume_point_of_next` early, because the host cannot predict the indirect jump to the resume point.
  Execution* next = nullptr;
  const std::uint8_t* const* resume_point_of_next = &kNoResumePoint;
  std::uint64_t instructions = 0;  // of the last run; upper half: loads and stores
  /// The state of the pipeline, as the bits of a Pipeline, if execution fell through from another block into the
  /// present block of a region. At all other times, the value is 0.
  std::uint64_t straight_pipeline = 0;
  const Instruction* slow_load = nullptr;  // the last load across two words
  std::uint64_t slow_load_when = 0;  // `instructions` at that time; if equal now, the load is in the present block
  std::uint64_t tick_offset = 0;     // active cycle c of the hart is tick c + offset of shared units
  bool alone = false;                // true if no other core uses the banks: then the table need not be read
  // Values of MXCSR, the host's control register for floating-point operations: outside of translated code, within
  // translated code, and after translated code.
  std::uint32_t float_control_outside = 0;
  std::uint32_t float_control = kFloatControl;
  std::uint32_t float_control_after = kFloatControl;
  CsrState* csrs = nullptr;  // of the same core
  std::uint32_t loaded = 0;  // the value of the last quiet load of translated code
  // The list of recorded steps from one function into another in translated code.
  Flow* flow = nullptr;              // next entry to write
  std::uint64_t position = 0;        // the cycle count at the end of the last run
  std::uint64_t instruction_fj = 0;  // energy of the last run
};

/// Value that means "no pc". A real pc is never odd.
inline constexpr std::uint32_t kNoPc = 1;

/// The units of a core that handlers use in addition to Execution. See runs/core.md.
struct HartUnits {
  Csrs& csrs;
  Traps& traps;
  DataPath& data_path;
  Fetch& fetch;
  BlockCache& blocks;
};

/// The part of a core's state that instruction handlers and translated code change, and the block in progress. During a
/// block, the counters and the pipeline have their values at the start of the block.
struct Execution {
  /// x0 to x31, then f0 to f31. x[0] stays 0; the last element receives the values written to x0.
  std::array<std::uint32_t, kNoRegister + 1> x{};
  std::uint32_t pc = 0;
  std::array<HardwareLoop, 2> loops{};  // 0 is the inner one
  FastRegion ram[2];
  Counters counters;
  EventCounts events{};  // advance while the program counts events
  Pipeline pipeline;

  // State of the block that is being executed.
  std::uint32_t extra_cycles = 0;          // beyond the static ones
  std::uint32_t first_stall = 0;           // of them: stall of the first instruction after a load
  const Instruction* exit = nullptr;       // everything before it has retired
  std::uint16_t* link = nullptr;           // slot for the number of the next block
  std::uint32_t next_block = 0;            // where translated code stopped; 0 = unknown
  bool jumped = false;                     // an unaligned target costs a cycle
  bool redirected = false;                 // left by a branch, jump, trap or return from one
  const Instruction* slow_load = nullptr;  // the last misaligned load
  const Instruction* waits_at = nullptr;   // the next instruction, if its line is absent or an observer is set
  Leave leave = Leave::normal;
  bool float_off = false;        // operations on floats are illegal (mstatus.FS)
  std::uint8_t rounding = 0;     // frm; next to the one before, because translated code checks both at once
  std::uint8_t float_flags = 0;  // fflags
  Reservation reservation;
  std::uint32_t trap_cause = 0;
  std::uint32_t trap_value = 0;
  std::uint32_t cut_pc = kNoPc;      // after a cut block, after a single instruction, or at the return of a trap
  const HartUnits* units = nullptr;  // of the same core
  Hart* hart = nullptr;              // its hart
  HostState host;

  /// Sets the next hart of the round; null if there is none.
  void set_next(Execution* next) {
    host.next = next;
    host.resume_point_of_next = next == nullptr ? &kNoResumePoint : &next->host.resume_point;
  }
  /// Drops the resume point, so that the next run starts in the interpreter.
  void drop_resume_point() { host.resume_point = nullptr; }

  // Functions for the block that is being executed. A function that leaves the block returns null, which the handler
  // must also return.

  /// Begins a block. `stall` is the number of stall cycles of its first instruction after a load.
  void begin_block(std::uint32_t cycles, std::uint32_t stall, const Instruction* slow_load_before) {
    extra_cycles = cycles + stall;
    first_stall = stall;
    redirected = false;
    slow_load = slow_load_before;
  }
  /// Resumes a block at an instruction that is not its first. The counters already contain the previous instructions of
  /// the block, so the function subtracts these instructions. The counters are not valid until the block is finished.
  void begin_block_inside(const Instruction* at);
  std::uint32_t stalled_before(const Instruction* at) const { return at->index == 0 ? first_stall : 0U; }
  /// Returns the active cycle in which an instruction starts.
  std::uint64_t cycle_of(const Instruction* at) const { return counters.cycles + at->cycles_before + extra_cycles; }
  /// Returns the cycle in which an instruction starts, for devices and counters. If the instruction waits for the
  /// result of a load, the returned cycle is before the stall, because execution may leave the block before the stall
  /// occurs.
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
  /// Stores the last two instructions before `last` in the pipeline, when the block continues.
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
