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

/// The cycles of some code by cause. The causes add up to the active cycles.
struct StackCost {
  std::array<std::int64_t, kCycleCauses> causes{};
  std::int64_t instructions = 0;
  Picoseconds asleep = 0;  // waiting for an interrupt or event; these are no active cycles

  std::int64_t cycles() const;
  StackCost& operator+=(const StackCost& other);
};

/// Accesses to one bank of a core's first memory, by all observed cores.
struct BankUse {
  std::uint64_t accesses = 0;
  std::uint64_t conflicts = 0;        // accesses that waited
  std::uint64_t conflict_cycles = 0;  // their waits
};

/// The cycles of one hart by cause, for each function. An instruction counts for the function in which it lies. A
/// function's cycles exclude the functions that it calls. Inlined code belongs to the function that contains it.
class CoreStack final : public Observer {
 public:
  /// `number` is the hart's number in the chip. All harts share `functions`. If the hart's first memory has shared
  /// banks, `banks` has an element for each bank, which counts the accesses. If not, `banks` is empty.
  CoreStack(const Soc& soc, unsigned number, Functions& functions, std::vector<BankUse>& banks);

  void retired(const Hart& hart, const Retired& instruction) override;
  void slept(const Hart& hart) override;
  void woke(const Hart& hart) override;
  void switched(const Hart& hart, bool on) override;
  void trapped(const Hart& hart, const Trapped& trap) override;
  /// Called at the end of the run. Counts the sleep of a sleeping hart up to now, and assigns causes to cycles after
  /// the last instruction.
  void finish();

  unsigned number() const { return number_; }
  const std::map<std::uint32_t, StackCost>& functions() const { return costs_; }
  StackCost total() const;

 private:
  /// The counts of the hart after the last instruction, and the events since then.
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
  std::map<std::uint32_t, StackCost> costs_;  // by place
  StackCost* current_ = nullptr;
  std::uint32_t place_ = 0;
  Last last_;
  Picoseconds asleep_since_ = -1;  // negative = awake
};

/// Divides the cycles of all harts among their causes.
class CycleStack {
 public:
  explicit CycleStack(const Soc& soc);

  Observer& hart(unsigned number) { return harts_[number]; }
  void finish();

  const std::deque<CoreStack>& harts() const { return harts_; }
  const Functions& functions() const { return functions_; }
  /// One element per bank of the cluster's L1; empty without a cluster.
  const std::vector<BankUse>& banks() const { return banks_; }

 private:
  Functions functions_;
  std::vector<BankUse> banks_;
  std::vector<BankUse> no_banks_;
  std::deque<CoreStack> harts_;
};

}  // namespace mebots::soc::observe
