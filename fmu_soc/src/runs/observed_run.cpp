// SPDX-License-Identifier: Apache-2.0
#include "runs/observed_run.hpp"

#include "runs/hart.hpp"

namespace mebots::soc {
namespace {

/// Returns the memory access of an instruction. Must be called before the instruction is executed, because it uses the
/// register values.
Access access_of(const Decoded& decoded, const Hart& hart) {
  const bool store = is_store(decoded.op);
  if (!is_load(decoded.op) && !store) return {};
  auto address = hart.reg(decoded.rs1);
  if (!is_post_increment(decoded.op)) {
    const bool by_register = has_step_register(traits_of(decoded.op).mode);
    address += by_register ? hart.reg(store ? decoded.rs3 : decoded.rs2) : static_cast<std::uint32_t>(decoded.imm);
  }
  const bool only_reserves = decoded.op == Op::lr_w;
  return {.address = address,
          .size = traits_of(decoded.op).size,
          .store = store,
          .reads = !store && decoded.op != Op::sc_w,
          .writes = store || (is_atomic(decoded.op) && !only_reserves)};
}

/// Returns the cycles of a jump that overlap with the misaligned load before the jump. This number was already
/// subtracted from the cycles of the load.
std::uint32_t hidden_by(const Execution& e, const Instruction* at) {
  const auto& next = at[1];
  const bool hides = e.slow_load == at && overlaps_slow(executed(*at, true), {next.op, next.rd, next.rs1});
  return hides ? at[2].cycles_before - next.cycles_before - 1U : 0U;
}

}  // namespace

void ObservedRun::observe(Observer* observer, bool sleeping) {
  observer_ = observer;
  restored(sleeping);
  flow_ = observer == nullptr ? nullptr : observer->flow();
  decoded_.record_flow(flow_);
  update_walk();
}

void ObservedRun::count_events(bool counts) {
  if (counts == counts_) return;
  counts_ = counts;
  account_.restart();
  update_walk();
}

void ObservedRun::update_walk() {
  interpreter_.set_walk(is_on() ? this : nullptr);
}

/// Reports a retired instruction to the observer and to the event counters.
void ObservedRun::retire(Retired& instruction, std::uint32_t hidden) {
  if (counts_ || wants_all()) account_.retire(instruction, hidden);
  if (counts_) account_.count_events(execution_.events, instruction, limit_.is_loose());
  if (observer_ != nullptr) observer_->retired(hart_, instruction);
}

/// Returns true if an observer needs a call after the instruction. `quiet` is the result of the observer's quiet().
bool ObservedRun::is_reported(const Instruction* at, const QuietCode& quiet) {
  if (!quiet.holds(at->pc) || !quiet.holds(at[1].pc) || at[1].op == Op::loop_end) return true;
  if (is_branch(at->op)) return !quiet.holds(static_cast<std::uint32_t>(at->imm));
  if (at->op == Op::jal) return at->rd != kNoRegister || !quiet.holds(static_cast<std::uint32_t>(at->imm));
  return at->op == Op::jalr || at->op == Op::mret;
}

/// Returns the first instruction from `at` on for which the observer needs a call. If no such instruction is before
/// `stop` or the end of the block, returns `stop` or the end.
const Instruction* ObservedRun::next_reported(const Instruction* at, const Instruction* stop) const {
  if (counts_) return at;
  const auto quiet = observer_->quiet();
  while (at != stop && !is_block_end(at->op) && !is_reported(at, quiet)) ++at;
  return at;
}

/// Returns a description of the instruction at `pc`, which was not executed yet.
Retired ObservedRun::preview(std::uint32_t pc) const {
  Retired retired;
  retired.pc = pc;
  retired.word = decoded_.blocks.word_at(pc).value_or(0);
  retired.decoded = decoded_.blocks.decode_word(retired.word);
  retired.access = access_of(retired.decoded, hart_);
  if (retired.access.store) retired.stored = execution_.x[retired.decoded.rs2];
  return retired;
}

void ObservedRun::step() {
  auto retired = preview(execution_.pc);
  const auto& e = execution_;
  if (const auto* at = decoded_.blocks.single(e.pc, e.pipeline.two_before, e.pipeline.before); at != nullptr) {
    account_.begin_alone(at[1].cycles_before);
  }
  const auto instructions = e.counters.instructions;
  interpreter_.step();
  if (e.counters.instructions != instructions) retire(retired, 0);
}

/// Runs a block. If blocks must not run past the limit, the observer may end the run after any reported instruction.
/// Therefore each reported instruction runs alone. The caller has already called before() for the first instruction.
void ObservedRun::run_block(const Block& block, std::uint32_t stall, bool alone) {
  const auto* first = decoded_.blocks.instructions(block);
  alone = alone || (wants_all() && !limit_.is_loose() && is_reported(first, observer_->quiet()));
  if (alone || !interpreter_.run(block, stall)) step();
  if (wants_all()) execution_.link = nullptr;
}

/// Executes instructions like Interpreter::run_until(), and calls the observer for those that it needs. During a call,
/// counters and pc have their values after the instruction. At other times, the counters have their values at the start
/// of the block.
const Instruction* ObservedRun::walk(const Instruction* at, const Instruction* stop) {
  auto& e = execution_;
  while (at != nullptr && at != stop) {
    if (const auto* told = next_reported(at, stop); told != at) {
      at = interpreter_.run_until(at, told);
      continue;
    }
    auto retired = preview(at->pc);
    account_.begin(e.start_of(at), at[1].cycles_before - at->cycles_before + e.stalled_before(at));
    const auto* next = interpreter_.run_until(at, at + 1);
    if (next != nullptr) e.pc = next->pc;
    const bool has_retired = e.exit->index > at->index;
    if (!has_retired) return nullptr;
    const auto at_start = e.counters;
    e.count_up_to(*e.exit);
    retire(retired, next == nullptr ? 0 : hidden_by(e, at));
    if (next != nullptr && observer_ != nullptr) observer_->before(hart_);
    e.counters = at_start;
    at = next;
  }
  return at;
}

void ObservedRun::slept() {
  if (observer_ != nullptr) observer_->slept(hart_);
  sleep_reported_ = observer_ != nullptr;
}

void ObservedRun::report_wake_up() {
  sleep_reported_ = false;
  if (observer_ != nullptr) observer_->woke(hart_);
}

}  // namespace mebots::soc
