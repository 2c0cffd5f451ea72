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

std::string trap_name(std::uint32_t cause) {
  const auto number = cause & ~cause::kInterrupt;
  return (cause & cause::kInterrupt) != 0 ? fmt::format("[interrupt {}]", number) : fmt::format("[trap {}]", number);
}

}  // namespace

CoreProfile::CoreProfile(const Soc& soc, unsigned number, Functions& functions)
    : soc_(soc), hart_(soc.hart(number)), number_(number), functions_(functions) {
  start();
}

/// Counts from now on. Who does not run has no later time of its own than when it stopped.
void CoreProfile::start() {
  const bool runs = soc_.is_on(number_) && !hart_.sleeping();
  charged_ = runs ? now() : now_of_chip();
  start_stack();
}

/// What the run has cost up to the instruction that has just finished.
Cost CoreProfile::now() const {
  const auto& counters = hart_.counters();
  return {static_cast<std::int64_t>(counters.cycles), static_cast<std::int64_t>(counters.instructions),
          soc_.is_on(number_) ? soc_.core_time(number_) : soc_.core_time(),
          energy_fj(number_ == 0 ? soc_.energy_at_core().total_j() : 0)};
}

Cost CoreProfile::now_of_chip() const {
  auto cost = now();
  cost.time_ps = soc_.now();
  cost.energy_fj = energy_fj(soc_.energy().total_j());
  return cost;
}

/// This hart's part of the chip's energy.
std::int64_t CoreProfile::energy_fj(double chip_j) const {
  const auto of_core = [this](unsigned number) {
    return std::llround(soc_.cluster_core_energy_j(number - 1) / kFemtojoule);
  };
  if (number_ != 0) return of_core(number_);
  auto rest = std::llround(chip_j / kFemtojoule);
  for (unsigned number = 1; number < soc_.harts(); ++number) rest -= of_core(number);
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
  cost.time_ps = std::max(cost.time_ps, charged_.time_ps);  // the cluster's clock became faster in its last block
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
  const auto next = hart.pc();
  const auto after = instruction.pc + decoded.length;
  if (is_jump(decoded.op) && is_link(decoded.rd)) {
    charge(now());
    // Through the other link register it goes back to a coroutine, whose place the call then takes.
    if (decoded.op == Op::jalr && is_link(decoded.rs1) && decoded.rs1 != decoded.rd) return_to(next);
    push(functions_.entered(next), after, Kind::function);
  } else if (decoded.op == Op::mret) {
    return_from_trap(next);
  } else if (decoded.op == Op::jalr && is_link(decoded.rs1) && return_to(next)) {
    return;
  } else if (next != after || !functions_.inside(stack_.back().place, next)) {
    go_to(next);
  }
}

/// While the function on top goes on, its cost is a difference that can wait.
QuietCode CoreProfile::quiet() const {
  return stack_.back().kind == Kind::function ? functions_.code(stack_.back().place) : QuietCode{};
}

/// The code of the frame on top goes on at `address`, perhaps as another function.
void CoreProfile::go_to(std::uint32_t address) {
  auto& top = stack_.back();
  const auto place = functions_.reached(address, top.place);
  if (place == top.place) return;
  charge(now());
  const auto parent = stack_.size() < 2 ? CallTree::kRoot : stack_[stack_.size() - 2].node;
  top.place = place;
  top.node = tree_.child(parent, place);
  ++tree_.node(top.node).calls;
}

/// Leaves frames down to the one that was called from just before `address`; false when there is none above the last
/// trap.
bool CoreProfile::return_to(std::uint32_t address) {
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
  go_to(address);
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

void CoreProfile::finish() {
  charge(now_of_chip());
}

}  // namespace mebots::soc::observe
