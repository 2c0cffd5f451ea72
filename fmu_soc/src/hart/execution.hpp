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
struct TrapState;
class DataPath;
class Fetch;
class Traps;

/// A range of RAM that loads and stores access through the fast path.
struct FastRegion {
  std::uint32_t base = 0;
  std::uint32_t span = 0;  // size of the range minus 3; 0 = no range
  std::uint8_t* data = nullptr;
  std::uint8_t* marks = nullptr;
  std::uint32_t wait_cycles = 0;  // cycles added to every access: latency in both directions
  BankSchedule* banks = nullptr;  // banks that other cores or the DMA also use; null = no other user

  bool is_shared() const { return banks != nullptr; }
};

/// The reason why execution left a block. `normal`: the hart continues at the next instruction. `stopped`: the run
/// ends, and Hart contains the reason.
enum class Leave : std::uint8_t { normal, trap, device, stop, sleep, event, turn, counting, stopped };

/// Registers of a hardware loop. The body runs again if the count is above 1 after the body's last instruction.
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

/// The word that lr.w has reserved, and the value of this word at that time. sc.w fails if the value has changed since
/// then.
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

/// Counters since reset. Programs cannot write them.
struct Counters {
  std::uint64_t instructions = 0;     // retired
  std::uint64_t cycles = 0;           // active cycles, without sleep
  std::uint64_t instruction_fj = 0;   // energy of instructions at the reference voltage
  std::uint64_t accesses = 0;         // loads and stores
  std::uint64_t device_accesses = 0;  // loads and stores to devices
  std::uint64_t far_accesses = 0;     // loads and stores to memories other than the first
  std::uint64_t fetch_cycles = 0;     // cycles of waits for the instruction cache

  /// Returns the number of loads and stores to the core's first memory.
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

/// Counts of RI5CY's events, indexed by their number in PCER. Events 0 (cycles) and 1 (instructions) are always 0 here,
/// because `Counters` contains these counts.
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

/// Value of MXCSR that rounds to nearest, masks all exceptions, and keeps subnormal numbers.
inline constexpr std::uint32_t kFloatControl = 0x1f80;

/// Data that the interpreter and translated code exchange.
struct HostState {
  /// First and last value of the register with which translated code counts cycles. Without shared banks, the register
  /// contains the number of remaining cycles and decreases to 0. With shared banks, it contains an address in the bank
  /// table and advances by one row per cycle.
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  /// Address at which translated code resumes after it stopped at the limit. Null if it cannot resume there, or if the
  /// hart's state has changed since then.
  const std::uint8_t* resume_point = nullptr;
  /// The hart with which translated code continues when this hart has reached its limit, without a return to the
  /// caller; null = none. `resume_point_of_next` points to that hart's `resume_point`, or to a null pointer. Translated
  /// code loads it early, because the host cannot predict the indirect jump to the resume point.
  Execution* next = nullptr;
  const std::uint8_t* const* resume_point_of_next = &kNoResumePoint;
  std::uint64_t instructions = 0;  // lower half: instructions of the last run; upper half: its loads and stores
  /// State of the pipeline, as the bits of a Pipeline, if execution continued into the present block from the end of
  /// another block, without a jump. Otherwise 0.
  std::uint64_t straight_pipeline = 0;
  const Instruction* slow_load = nullptr;  // the last load that crossed a word boundary
  /// Value of `instructions` at the load `slow_load`. If `instructions` still has this value, the load is in the
  /// present block.
  std::uint64_t slow_load_when = 0;
  std::uint64_t tick_offset = 0;  // active cycle c of the hart is tick c + tick_offset of the shared units
  bool alone = false;             // if true, no other core uses the banks, so the bank table is not read
  // Values of MXCSR, the host's control register for floating-point operations: outside of translated code, within it,
  // and after it.
  std::uint32_t float_control_outside = 0;
  std::uint32_t float_control = kFloatControl;
  std::uint32_t float_control_after = kFloatControl;
  CsrState* csrs = nullptr;    // control and status registers of this core
  TrapState* traps = nullptr;  // state of this core's trap handling
  bool serves_calls = false;   // true if the host may serve an ecall
  std::uint32_t loaded = 0;    // value of the last load that translated code performed with load_quietly()
  // Translated code records the steps that may enter another function in a list: see Flow.
  Flow* flow = nullptr;              // next entry to write
  std::uint64_t position = 0;        // value of the register that counts cycles, at the end of the last run
  std::uint64_t instruction_fj = 0;  // energy of the last run
};

/// Means "no pc". Valid addresses are even.
inline constexpr std::uint32_t kNoPc = 1;

/// The parts of a core, such as CSRs and data path, that instruction handlers use in addition to Execution. See
/// runs/core.md.
struct HartUnits {
  Csrs& csrs;
  Traps& traps;
  DataPath& data_path;
  Fetch& fetch;
  BlockCache& blocks;
};

/// The part of a core's state that handlers and translated code change, and the state of the block that is being
/// executed. During a block, the counters and the pipeline contain their values from the start of the block.
struct Execution {
  /// x0 to x31, then f0 to f31. x[0] is always 0. The last element receives the values that instructions write to x0.
  std::array<std::uint32_t, kNoRegister + 1> x{};
  std::uint32_t pc = 0;
  std::array<HardwareLoop, 2> loops{};  // loops[0] is the inner loop
  FastRegion ram[2];
  Counters counters;
  EventCounts events{};  // only counted while the program counts events
  Pipeline pipeline;

  // State of the block that is being executed.
  std::uint32_t extra_cycles = 0;          // cycles in addition to those known from decoding
  std::uint32_t first_stall = 0;           // part of extra_cycles: stall of the first instruction after a load
  const Instruction* exit = nullptr;       // all instructions before this one have retired
  std::uint16_t* link = nullptr;           // where to store the number of the next block
  std::uint32_t next_block = 0;            // block at which translated code stopped; 0 = unknown
  bool jumped = false;                     // if true, an unaligned jump target costs a cycle
  bool redirected = false;                 // the block ended with a taken branch, jump, trap or mret
  const Instruction* slow_load = nullptr;  // the last misaligned load
  const Instruction* waits_at = nullptr;   // instruction before which the interpreter interrupted the block
  Leave leave = Leave::normal;
  bool float_off = false;        // if true, floating-point instructions are illegal (mstatus.FS)
  std::uint8_t rounding = 0;     // CSR frm; must follow float_off, because translated code checks both at once
  std::uint8_t float_flags = 0;  // CSR fflags
  Reservation reservation;
  std::uint32_t trap_cause = 0;
  std::uint32_t trap_value = 0;
  /// Pc at which a limit interrupted a block, at which a single instruction ended, or to which an interrupt returned.
  /// If blocks must not run past the limit, no new block is decoded at this pc, because blocks at all such pcs would
  /// fill the cache.
  std::uint32_t cut_pc = kNoPc;
  const HartUnits* units = nullptr;  // units of this core
  Hart* hart = nullptr;              // the hart of this core
  HostState host;

  /// Sets the hart with which translated code continues after this one; null = none.
  void set_next(Execution* next) {
    host.next = next;
    host.resume_point_of_next = next == nullptr ? &kNoResumePoint : &next->host.resume_point;
  }
  /// Drops the resume point, so that the next run starts in the interpreter.
  void drop_resume_point() { host.resume_point = nullptr; }

  // The following functions apply to the block that is being executed. If a function leaves the block, it returns null,
  // and the handler must also return null.

  /// Begins a block. `stall` is the number of cycles that the first instruction stalls after a load.
  void begin_block(std::uint32_t cycles, std::uint32_t stall, const Instruction* slow_load_before) {
    extra_cycles = cycles + stall;
    first_stall = stall;
    redirected = false;
    slow_load = slow_load_before;
  }
  /// Resumes a block at `at`, which is not its first instruction. finish_block() adds all instructions of the block to
  /// the counters. Therefore this function first subtracts those before `at`. The counters are invalid until
  /// finish_block().
  void begin_block_inside(const Instruction* at);
  std::uint32_t stalled_before(const Instruction* at) const { return at->index == 0 ? first_stall : 0U; }
  /// Returns the active cycle in which the instruction starts.
  std::uint64_t cycle_of(const Instruction* at) const { return counters.cycles + at->cycles_before + extra_cycles; }
  /// Returns the cycle in which the instruction starts, for devices and counters. If the first instruction stalls after
  /// a load, returns the cycle before the stall, because execution may leave the block before the stall occurs.
  std::uint64_t start_of(const Instruction* at) const { return cycle_of(at) - stalled_before(at); }
  const Instruction* leave_after(const Instruction* at, Leave why);
  const Instruction* leave_before(const Instruction* at, Leave why);
  /// Leaves the block before `at`, which raises an exception.
  const Instruction* raise(const Instruction* at, std::uint32_t cause, std::uint32_t value);
  /// Adds the instructions before `last` to the counters.
  void count_up_to(const Instruction& last) {
    counters.instructions += last.index;
    counters.cycles += last.cycles_before + extra_cycles;
    counters.instruction_fj += last.energy_before_fj;
    counters.accesses += last.accesses_before;
  }
  /// Adds the instructions before `exit` to the counters, and updates the pipeline.
  void finish_block();
  /// Sets the pipeline to the last two instructions before `last`.
  void remember(const Instruction* last);
};

inline void Execution::begin_block_inside(const Instruction* at) {
  MEBOTS_ASSERT(counters.instructions >= at->index && counters.cycles >= at->cycles_before);
  MEBOTS_ASSERT(counters.accesses >= at->accesses_before);
  counters.instructions -= at->index;
  counters.cycles -= at->cycles_before;
  counters.instruction_fj -= at->energy_before_fj;
  counters.accesses -= at->accesses_before;
  if (at->index == 1) pipeline.before = pipeline.two_before;  // the instruction before the block; see remember()
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
