// SPDX-License-Identifier: Apache-2.0
#include "observe/cycle_stack.hpp"

#include <numeric>

namespace mebots::soc::observe {

std::int64_t StackCost::cycles() const {
  return std::accumulate(causes.begin(), causes.end(), std::int64_t{0});
}

StackCost& StackCost::operator+=(const StackCost& other) {
  for (std::size_t i = 0; i < causes.size(); ++i) causes[i] += other.causes[i];
  instructions += other.instructions;
  asleep += other.asleep;
  return *this;
}

CoreStack::CoreStack(const Soc& soc, unsigned number, Functions& functions, std::vector<BankUse>& banks)
    : soc_(soc),
      number_(number),
      functions_(functions),
      banks_(banks),
      last_{.counters = soc.hart(number).counters()} {}

StackCost& CoreStack::at(std::uint32_t pc) {
  if (current_ != nullptr && functions_.inside(place_, pc)) return *current_;
  place_ = current_ == nullptr ? functions_.entered(pc) : functions_.reached(pc, place_);
  current_ = &costs_[place_];
  return *current_;
}

void CoreStack::retired(const Hart& hart, const Retired& instruction) {
  auto& cost = at(instruction.pc);
  const auto& shares = instruction.cycles.cycles;
  for (std::size_t i = 0; i < shares.size(); ++i) cost.causes[i] += shares[i];
  ++cost.instructions;
  if (!banks_.empty()) count_bank(hart, instruction);
  last_ = {.counters = hart.counters(), .jump = is_jump(instruction.decoded.op)};
}

void CoreStack::count_bank(const Hart& hart, const Retired& instruction) {
  if (hart.counters().near_accesses() == last_.counters.near_accesses()) return;
  auto& bank = banks_[instruction.access.address / 4 % banks_.size()];
  const auto waited = instruction.cycles[CycleCause::bank_conflict];
  ++bank.accesses;
  if (waited > 0) ++bank.conflicts;
  bank.conflict_cycles += static_cast<std::uint64_t>(waited);
}

void CoreStack::slept(const Hart& hart) {
  at(hart.pc());
  asleep_since_ = now();
}

void CoreStack::woke(const Hart& /*hart*/) {
  end_sleep(now());
}

void CoreStack::end_sleep(Picoseconds time) {
  if (asleep_since_ < 0 || current_ == nullptr) return;
  current_->asleep += time - asleep_since_;
  asleep_since_ = -1;
}

void CoreStack::switched(const Hart& hart, bool /*on*/) {
  woke(hart);
}

void CoreStack::trapped(const Hart& /*hart*/, const Trapped& /*trap*/) {
  last_.trap_cycles += kTrapEntryCycles;
}

void CoreStack::finish() {
  const auto& counters = soc_.hart(number_).counters();
  if (counters.cycles != last_.counters.cycles) {
    const auto cause = [this](CycleCause of) -> std::int64_t& {
      return at(soc_.hart(number_).pc()).causes[static_cast<std::size_t>(of)];
    };
    const auto fetched = static_cast<std::int64_t>(counters.fetch_cycles - last_.counters.fetch_cycles);
    const auto all = static_cast<std::int64_t>(counters.cycles - last_.counters.cycles);
    cause(CycleCause::cache) += fetched;
    cause(CycleCause::trap) += last_.trap_cycles;
    cause(last_.jump ? CycleCause::jump : CycleCause::branch) += all - fetched - last_.trap_cycles;
    last_.counters = counters;
  }
  end_sleep(soc_.now());
}

StackCost CoreStack::total() const {
  StackCost sum;
  for (const auto& [place, cost] : costs_) sum += cost;
  return sum;
}

CycleStack::CycleStack(const Soc& soc) : functions_(soc.program()) {
  if (const auto* cluster = soc.cluster(); cluster != nullptr) banks_.resize(cluster->l1_banks());
  for (unsigned number = 0; number < soc.harts(); ++number) {
    harts_.emplace_back(soc, number, functions_, number == kFabricControllerHart ? no_banks_ : banks_);
  }
}

void CycleStack::finish() {
  for (auto& hart : harts_) hart.finish();
}

}  // namespace mebots::soc::observe
