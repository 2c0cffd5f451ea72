// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/observer.hpp"
#include "observe/functions.hpp"
#include "soc/soc.hpp"

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

namespace mebots::soc::observe {

/// Stores the cycles of some code for each cause. The sum over the causes is the number of active cycles.
struct StackCost {
  std::array<std::int64_t, kCycleCauses> causes{};
  std::int64_t instructions = 0;
  Picoseconds asleep = 0;  // time of sleep, which is not part of the cycles

  std::int64_t cycles() const;
  StackCost& operator+=(const StackCost& other);
};

/// Counts the accesses of the cluster's cores to one bank of L1, their first memory.
struct BankUse {
  std::uint64_t accesses = 0;
  std::uint64_t conflicts = 0;
  std::uint64_t conflict_cycles = 0;
};

/// Counts the cycles of one hart for each function and cause. An instruction counts for the function that contains it.
/// The cycles of a function exclude those of the functions that it calls. Inlined code belongs to the function that
/// contains it.
class CoreStack final : public Observer {
 public:
  /// `number` is the number of the hart in the chip. All harts share `functions`. `banks` counts the accesses to each
  /// bank of the hart's first memory. If the memory has no shared banks, `banks` is empty.
  CoreStack(const Soc& soc, unsigned number, Functions& functions, std::vector<BankUse>& banks);

  void retired(const Hart& hart, const Retired& instruction) override;
  void slept(const Hart& hart) override;
  void woke(const Hart& hart) override;
  void switched(const Hart& hart, bool on) override;
  void trapped(const Hart& hart, const Trapped& trap) override;
  /// Adds the costs since the last instruction, including a present sleep. Must be called at the end of the run.
  void finish();

  unsigned number() const { return number_; }
  const std::map<std::uint32_t, StackCost>& functions() const { return costs_; }
  StackCost total() const;

 private:
  /// Counts of the hart at the last instruction, and events since then.
  struct Last {
    Counters counters;
    bool jump = false;
    std::int64_t trap_cycles = 0;
  };

  Picoseconds now() const { return soc_.core_time(soc_.is_on(number_) ? number_ : kFabricControllerHart); }
  void count_bank(const Hart& hart, const Retired& instruction);
  void end_sleep(Picoseconds time);
  StackCost& at(std::uint32_t pc);

  const Soc& soc_;
  unsigned number_;
  Functions& functions_;
  std::vector<BankUse>& banks_;
  std::map<std::uint32_t, StackCost> costs_;  // indexed by the number of a place in Functions
  StackCost* current_ = nullptr;
  std::uint32_t place_ = 0;
  Last last_;
  Picoseconds asleep_since_ = -1;  // start of the present sleep; negative = the hart is awake
};

class CycleStack {
 public:
  explicit CycleStack(const Soc& soc);

  Observer& hart(unsigned number) { return harts_[number]; }
  void finish();

  const std::deque<CoreStack>& harts() const { return harts_; }
  const Functions& functions() const { return functions_; }
  /// Returns one element for each bank of the cluster's L1. Without a cluster, the list is empty.
  const std::vector<BankUse>& banks() const { return banks_; }

 private:
  Functions functions_;
  std::vector<BankUse> banks_;
  std::vector<BankUse> no_banks_;
  std::deque<CoreStack> harts_;
};

}  // namespace mebots::soc::observe
