// SPDX-License-Identifier: Apache-2.0
#include "hart/cycle_account.hpp"

namespace mebots::soc {
namespace {

/// Numbers of RI5CY's events in PCER. Source: RI5CY user manual 4.45, "Performance counters". Source of the five
/// external events: riscv_cs_registers.sv of pulp-platform/riscv with PERF_EXT_ID = 12, and pcer_v2.h of the PULP SDK.
namespace event {
enum : unsigned {
  kLoadStall = 2,
  kJumpStall = 3,
  kFetchMiss = 4,
  kLoad = 5,
  kStore = 6,
  kJump = 7,
  kBranch = 8,
  kTakenBranch = 9,
  kCompressed = 10,
  kEventLoad = 11,
  kLoadExternal = 12,
  kStoreExternal = 13,
  kLoadExternalCycles = 14,
  kStoreExternalCycles = 15,
  kContention = 16,
};
}  // namespace event
static_assert(event::kContention + 1 == kEventCounters);

/// Returns the cause of an operation's cycles, except for its first cycle.
CycleCause own_cause(Op op) {
  if (is_multi_cycle(op)) return CycleCause::multiply_divide;
  if (is_float(op)) return CycleCause::floats;
  return op == Op::mret ? CycleCause::trap : CycleCause::system;
}

}  // namespace

CycleAccount::Mark CycleAccount::now() const {
  const auto& counters = execution_.counters;
  return {counters.cycles, counters.fetch_cycles, counters.far_accesses, counters.device_accesses};
}

std::int32_t CycleAccount::passed_since(std::uint64_t cycles) const {
  return static_cast<std::int32_t>(execution_.counters.cycles - cycles);
}

void CycleAccount::restart() {
  last_ = now();
  trap_cycles_ = 0;
  hidden_ = 0;
  before_ = execution_.pipeline.before;  // a restored state contains the previous instruction
}

void CycleAccount::begin(std::uint64_t start, std::uint32_t decoded) {
  const auto fetched = execution_.counters.fetch_cycles - last_.fetch_cycles;
  gap_ = static_cast<std::int32_t>(start - last_.cycles - fetched);
  decoded_ = static_cast<std::int32_t>(decoded);
}

void CycleAccount::begin_alone(std::uint32_t decoded) {
  begin(execution_.counters.cycles, decoded);
}

void CycleAccount::retire(Retired& instruction, std::uint32_t hidden) {
  const auto& counters = execution_.counters;
  auto& shares = instruction.cycles = {};
  const auto fetched = static_cast<std::int32_t>(counters.fetch_cycles - last_.fetch_cycles);
  const auto extra = passed_since(last_.cycles) - fetched - gap_ - decoded_ + static_cast<std::int32_t>(hidden);
  decoded_ -= hidden_;
  hidden_ = static_cast<std::int32_t>(hidden);
  const auto entry = static_cast<std::int32_t>(trap_cycles_);
  shares[CycleCause::cache] = fetched;
  shares[CycleCause::trap] = entry;
  shares[is_jump(before_.op) ? CycleCause::jump : CycleCause::branch] = gap_ - entry;
  is_far_ = counters.far_accesses != last_.far_accesses;
  is_device_ = counters.device_accesses != last_.device_accesses;
  share_decoded(shares, instruction.decoded);
  share_extra(shares, instruction, extra);
  before_ = executed(instruction.decoded, false);
  trap_cycles_ = 0;
  last_ = now();
}

void CycleAccount::share_decoded(CycleShares& shares, const Decoded& instruction) {
  shares[CycleCause::base] += 1;
  if (is_jump(instruction.op)) {
    share_jump(shares, instruction);
    return;
  }
  const auto own = static_cast<std::int32_t>(own_cycles(timing_, {.op = instruction.op, .imm = instruction.imm}));
  shares[own_cause(instruction.op)] += own - 1;
  shares[CycleCause::load_use] += decoded_ - own;
  waited_for_load_ = decoded_ > own;
}

/// Assigns causes to the cycles of a jump. A jump takes two cycles, or one if it is fetched while the previous
/// instruction still takes several cycles. It may also wait for its address register, or for a load directly before it.
void CycleAccount::share_jump(CycleShares& shares, const Decoded& jump) {
  const bool is_after_load = is_load(before_.op) && before_.writes();
  waited_for_load_ = decoded_ > 2 && is_after_load && (jump.rd == before_.rd || jump.rs1 == before_.rd);
  const auto own = decoded_ < 2 ? decoded_ : 2;
  const auto load = waited_for_load_ ? 1 : 0;
  shares[CycleCause::jump] += own - 1;
  shares[CycleCause::load_use] += load;
  shares[CycleCause::jump_register] += decoded_ - own - load;
}

/// Assigns causes to the cycles that were not known from decoding.
void CycleAccount::share_extra(CycleShares& shares, const Retired& instruction, std::int32_t extra) const {
  const auto op = instruction.decoded.op;
  const auto& access = instruction.access;
  if (is_branch(op)) {
    shares[CycleCause::branch] += extra;
  } else if (is_divide(op)) {
    shares[CycleCause::multiply_divide] += extra;
  } else if (access.size == 0) {
    shares[CycleCause::other] += extra;
  } else if (is_device_) {
    shares[CycleCause::device] += extra;
  } else {
    const bool twice = crosses_word(access.address, access.size);
    const auto second = twice ? static_cast<std::int32_t>(kMisalignedExtra) : 0;
    shares[CycleCause::misaligned] += second;
    const auto wait = static_cast<std::int32_t>(execution_.ram[0].wait_cycles) * (twice ? 2 : 1);
    const auto latency = is_far_ ? 0 : wait;
    shares[CycleCause::memory] += latency;
    shares[is_far_ ? CycleCause::far_memory : CycleCause::bank_conflict] += extra - second - latency;
  }
}

void CycleAccount::count_events(EventCounts& events, const Retired& instruction, bool external) const {
  const auto& shares = instruction.cycles;
  const auto op = instruction.decoded.op;
  const auto cycles = [&](CycleCause cause) { return static_cast<std::uint64_t>(shares[cause]); };
  const auto one = [](bool happened) { return happened ? 1U : 0U; };
  events[event::kLoadStall] += one(waited_for_load_);
  events[event::kJumpStall] += one(is_jump(op) && (shares[CycleCause::jump_register] > 0));
  events[event::kFetchMiss] += cycles(CycleCause::cache);
  events[event::kJump] += one(is_jump(op));
  events[event::kBranch] += one(is_branch(op));
  events[event::kTakenBranch] +=
      one(is_branch(op) && shares[CycleCause::branch] >= static_cast<int>(kTakenBranchExtra));
  events[event::kCompressed] += one(instruction.decoded.length == 2);
  if (instruction.access.size == 0) return;
  const auto& access = instruction.access;
  const auto accesses = one(true) + one(crosses_word(access.address, access.size));
  events[access.store ? event::kStore : event::kLoad] += accesses;
  if (op == Op::p_elw) events[event::kEventLoad] += cycles(CycleCause::device);
  if (!external) return;
  events[event::kContention] += cycles(CycleCause::bank_conflict);
  if (!is_far_ && !is_device_) return;
  events[access.store ? event::kStoreExternal : event::kLoadExternal] += accesses;
  events[access.store ? event::kStoreExternalCycles : event::kLoadExternalCycles] +=
      accesses + cycles(CycleCause::device) + cycles(CycleCause::far_memory);
}

}  // namespace mebots::soc
