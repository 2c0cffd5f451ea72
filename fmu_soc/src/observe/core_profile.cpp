// SPDX-License-Identifier: Apache-2.0
#include "observe/core_profile.hpp"

#include "energy/table.hpp"
#include "hart/csr_numbers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace mebots::soc::observe {
namespace {

bool is_link(unsigned reg) {
  return reg == 1 || reg == 5;
}

/// Rounds like std::llround, but is inlined.
std::int64_t rounded(double value) {
  return static_cast<std::int64_t>(value < 0 ? value - 0.5 : value + 0.5);
}

std::string trap_name(std::uint32_t cause) {
  const auto number = cause & ~cause::kInterrupt;
  return (cause & cause::kInterrupt) != 0 ? fmt::format("[interrupt {}]", number) : fmt::format("[trap {}]", number);
}

}  // namespace

CoreProfile::CoreProfile(const Soc& soc, unsigned number, Functions& functions)
    : soc_(soc), hart_(soc.hart(number)), number_(number), functions_(functions) {
  start();
}

/// Starts to count. If the core does not run, starts at the time of the chip, because the core's own time has stopped.
void CoreProfile::start() {
  charged_ = runs() ? now() : now_of_chip();
  start_stack();
}

/// Returns the cost of the run up to the instruction that has just finished.
Cost CoreProfile::now() const {
  const auto& counters = hart_.counters();
  return {static_cast<std::int64_t>(counters.cycles), static_cast<std::int64_t>(counters.instructions),
          soc_.is_on(number_) ? soc_.core_time(number_) : soc_.core_time(),
          energy_fj(number_ == kFabricControllerHart ? soc_.power().energy_at_core().total_j() : 0)};
}

Cost CoreProfile::now_of_chip() const {
  auto cost = now();
  cost.time_ps = soc_.now();
  cost.energy_fj = energy_fj(soc_.energy().total_j());
  return cost;
}

/// Returns the part of the chip's energy that this hart gets: see the class comment.
std::int64_t CoreProfile::energy_fj(double chip_j) const {
  const auto of_core = [this](unsigned number) {
    return std::llround(soc_.power().cluster_core_energy_j(core_of_hart(number)) / kFemtojoule);
  };
  if (number_ != kFabricControllerHart) return of_core(number_);
  auto rest = std::llround(chip_j / kFemtojoule);
  for (auto number = hart_of_core(0); number < soc_.harts(); ++number) rest -= of_core(number);
  return rest;
}

void CoreProfile::start_stack() {
  stack_.clear();
  if (!soc_.is_on(number_)) {
    push(functions_.named("[off]"), 0, Kind::off);
    return;
  }
  push(functions_.entered(hart_.pc()), 0, Kind::function);
  if (hart_.sleeping()) push(functions_.named("[asleep]"), 0, Kind::sleep);
}

void CoreProfile::charge(const Cost& now) {
  auto cost = now;
  // If the cluster's clock became faster in its last block, the time may have decreased.
  cost.time_ps = std::max(cost.time_ps, charged_.time_ps);
  tree_.node(stack_.back().node).self += cost - charged_;
  charged_ = cost;
}

void CoreProfile::push(std::uint32_t place, std::uint32_t return_address, Kind kind) {
  const auto parent = stack_.empty() ? CallTree::kRoot : stack_.back().node;
  const auto node = tree_.child(parent, place);
  ++tree_.node(node).calls;
  stack_.push_back({node, place, return_address, kind});
}

void CoreProfile::retired(const Hart& hart, const Retired& instruction) {
  const auto& decoded = instruction.decoded;
  step({decoded.op, decoded.rd, decoded.rs1, instruction.pc + decoded.length, hart.pc()}, [this] { return now(); });
}

/// Adds the costs of steps that translated code has recorded. Only this hart's counts have changed during these steps.
/// Therefore the energy at each step is the present energy, minus the energy of the counts that this hart has added
/// since the step. The time of a step is computed from the hart's cycles and rounded as in now(), so that rounding
/// errors do not accumulate.
void CoreProfile::flowed(const Hart& hart, std::span<const Flow> steps) {
  const auto last = now();
  const auto per_count = soc_.power().energy_per_count(number_);
  const auto per_fetch_cycle_j =
      number_ == 0 ? soc_.power().refill_words_per_fetch_cycle() * per_count.refill_word_j : 0.0;
  const auto& end = steps.back();
  // The present energy also contains refills of cache lines that arrived after the last step. Therefore the hart's
  // counter is used instead of end.fetch_cycles.
  const auto fetch_cycles = hart.counters().fetch_cycles;
  for (const auto& flow : steps) {
    const auto cycles = static_cast<double>(end.cycles - flow.cycles);
    const auto far = static_cast<double>(end.far_accesses - flow.far_accesses);
    const auto near = static_cast<double>(end.accesses - flow.accesses) - far;
    const auto later_j = cycles * per_count.cycle_j +
                         static_cast<double>(end.instruction_fj - flow.instruction_fj) * per_count.instruction_j +
                         near * per_count.near_access_j + far * per_count.far_access_j +
                         static_cast<double>(fetch_cycles - flow.fetch_cycles) * per_fetch_cycle_j;
    const Cost cost{static_cast<std::int64_t>(flow.cycles), static_cast<std::int64_t>(flow.instructions),
                    soc_.core_time_at(number_, flow.cycles), last.energy_fj - rounded(later_j / kFemtojoule)};
    const auto* at = flow.at;
    step({at->op, at->rd, at->rs1, at[1].pc, flow.next}, [&cost] { return cost; });
  }
}

template <typename Now>
void CoreProfile::step(const Step& step, Now now) {
  if (is_jump(step.op) && is_link(step.rd)) {
    charge(now());
    // A coroutine is called through one link register and may return through the other one. In this case, the called
    // function replaces the frame of the coroutine.
    if (step.op == Op::jalr && is_link(step.rs1) && step.rd != step.rs1) return_to(step.next, now);
    push(functions_.entered(step.next), step.after, Kind::function);
  } else if (step.op == Op::mret) {
    return_from_trap(step.next);
  } else {
    // After a call that does not return, the code may continue in another function.
    const bool returned = step.op == Op::jalr && is_link(step.rs1) && return_to(step.next, now);
    if (returned || step.next != step.after || !functions_.inside(stack_.back().place, step.next)) {
      go_to(step.next, now);
    }
  }
}

/// Returns the code of the function at the top of the stack. In this code, costs need not be added after each
/// instruction.
QuietCode CoreProfile::quiet() const {
  return stack_.back().kind == Kind::function ? functions_.code(stack_.back().place) : QuietCode{};
}

/// Continues at `address` without a call or return. If the address is in another function, this function replaces the
/// present one at the top of the stack.
template <typename Now>
void CoreProfile::go_to(std::uint32_t address, Now now) {
  auto& top = stack_.back();
  const auto place = functions_.reached(address, top.place);
  if (place == top.place) return;
  charge(now());
  const auto parent = stack_.size() < 2 ? CallTree::kRoot : stack_[stack_.size() - 2].node;
  top.place = place;
  top.node = tree_.child(parent, place);
  ++tree_.node(top.node).calls;
}

/// Removes frames up to and including the frame whose call returns to `address`. If there is no such frame above the
/// last trap, returns false.
template <typename Now>
bool CoreProfile::return_to(std::uint32_t address, Now now) {
  for (auto depth = stack_.size(); depth-- > 1;) {
    if (stack_[depth].kind != Kind::function) return false;
    if (stack_[depth].return_address == address) {
      charge(now());
      stack_.resize(depth);
      return true;
    }
  }
  return false;
}

void CoreProfile::return_from_trap(std::uint32_t address) {
  charge(now());
  for (auto depth = stack_.size(); depth-- > 1;) {
    if (stack_[depth].kind == Kind::trap) {
      stack_.resize(depth);
      break;
    }
  }
  go_to(address, [this] { return now(); });
}

void CoreProfile::trapped(const Hart& hart, const Trapped& trap) {
  charge(now());
  push(functions_.named(trap_name(trap.cause)), trap.pc, Kind::trap);
  push(functions_.entered(hart.pc()), 0, Kind::function);
}

void CoreProfile::slept(const Hart& /*hart*/) {
  charge(now());
  push(functions_.named("[asleep]"), 0, Kind::sleep);
}

void CoreProfile::woke(const Hart& /*hart*/) {
  if (stack_.back().kind != Kind::sleep) return;
  charge(now());
  stack_.pop_back();
}

void CoreProfile::switched(const Hart& /*hart*/, bool /*on*/) {
  charge(now());
  start_stack();
}

void CoreProfile::settle() {
  charge(runs() ? now() : now_of_chip());
}

void CoreProfile::finish() {
  charge(now_of_chip());
}

}  // namespace mebots::soc::observe
