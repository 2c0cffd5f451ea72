// SPDX-License-Identifier: Apache-2.0
#include "observe/profile.hpp"

#include "hart/csr_numbers.hpp"
#include "observe/profile_formats.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>

namespace mebots::soc::observe {
namespace {

constexpr double kFemtojoule = 1e-15;

bool is_link(unsigned reg) {
  return reg == 1 || reg == 5;
}

bool wants_callgrind(const std::string& option, const std::string& path) {
  const auto ending = std::filesystem::path(path).extension();
  if (ending == ".json") return false;
  if (ending == ".callgrind" || ending == ".out") return true;
  throw Error(fmt::format(
      "{} {}: the name must end in .json (for speedscope) or in .callgrind or .out (for KCachegrind)", option, path));
}

std::string trap_name(std::uint32_t cause) {
  const auto number = cause & ~cause::kInterrupt;
  return (cause & cause::kInterrupt) != 0 ? fmt::format("[interrupt {}]", number) : fmt::format("[trap {}]", number);
}

}  // namespace

Profile::Profile(const std::string& option, const std::string& path, const Soc& soc)
    : soc_(soc), functions_(soc.program()), callgrind_(wants_callgrind(option, path)), file_(option, path) {
  charged_ = now();
  asleep_ = functions_.named("[asleep]");
  push(functions_.entered(soc.hart().pc()), 0, Kind::function);
}

/// What the run has cost up to the instruction that has just finished.
Cost Profile::now() const {
  const auto& counters = soc_.hart().counters();
  return {static_cast<std::int64_t>(counters.cycles), static_cast<std::int64_t>(counters.instructions),
          soc_.core_time(), std::llround(soc_.energy_at_core().total_j() / kFemtojoule)};
}

void Profile::charge(const Cost& now) {
  tree_.node(stack_.back().node).self += now - charged_;
  charged_ = now;
}

void Profile::push(std::uint32_t place, std::uint32_t return_address, Kind kind) {
  const auto parent = stack_.empty() ? CallTree::kRoot : stack_.back().node;
  const auto node = tree_.child(parent, place);
  ++tree_.node(node).calls;
  stack_.push_back({node, place, return_address, kind});
}

void Profile::retired(const Hart& hart, const Retired& instruction) {
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

/// The code of the frame on top goes on at `address`, perhaps as another function.
void Profile::go_to(std::uint32_t address) {
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
bool Profile::return_to(std::uint32_t address) {
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

void Profile::return_from_trap(std::uint32_t address) {
  charge(now());
  for (auto depth = stack_.size(); depth-- > 1;) {
    if (stack_[depth].kind == Kind::trap) {
      stack_.resize(depth);
      break;
    }
  }
  go_to(address);
}

void Profile::trapped(const Hart& hart, const Trapped& trap) {
  charge(now());
  push(functions_.named(trap_name(trap.cause)), trap.pc, Kind::trap);
  push(functions_.entered(hart.pc()), 0, Kind::function);
}

void Profile::slept(const Hart& /*hart*/) {
  charge(now());
  push(asleep_, 0, Kind::sleep);
}

void Profile::woke(const Hart& /*hart*/) {
  if (stack_.back().kind != Kind::sleep) return;
  charge(now());
  stack_.pop_back();
}

void Profile::restored() {
  charged_ = now();
  stack_.clear();
  push(functions_.entered(soc_.hart().pc()), 0, Kind::function);
  if (soc_.hart().sleeping()) push(asleep_, 0, Kind::sleep);
}

void Profile::finish() {
  auto end = now();
  end.time_ps = soc_.now();
  end.energy_fj = std::llround(soc_.energy().total_j() / kFemtojoule);
  charge(end);
  if (callgrind_) {
    write_callgrind(tree_, functions_, soc_.program().origin(), file_);
  } else {
    write_speedscope(tree_, functions_, soc_.program().origin(), file_);
  }
  file_.close();
}

}  // namespace mebots::soc::observe
