// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/cycle_account.hpp"
#include "hart/execution.hpp"
#include "hart/interpreter.hpp"
#include "hart/observer.hpp"
#include "runs/decoded_code.hpp"

#include <cstdint>
#include <span>

namespace mebots::soc {

/// Runs a core and calls its observer after each instruction that the observer needs. The results are the same as
/// without an observer. This class also runs a core whose program counts events, because each instruction must be
/// analysed.
class ObservedRun final : private BlockWalk {
 public:
  ObservedRun(const Hart& hart, Execution& execution, DecodedCode& decoded, Interpreter& interpreter,
              const RunLimit& limit)
      : hart_(hart),
        execution_(execution),
        decoded_(decoded),
        interpreter_(interpreter),
        limit_(limit),
        account_(execution, decoded.blocks.timing()) {}

  /// Sets the observer; null removes it. `sleeping` is true if the core sleeps now.
  void observe(Observer* observer, bool sleeping);
  /// Starts or stops the counting of events. While events are counted, no code is translated.
  void count_events(bool counts);
  /// Returns true if this class, and not the interpreter or translated code, must run the instructions.
  bool is_on() const { return observer_ != nullptr || counts_; }
  Observer* observer() const { return observer_; }
  /// True if there is an observer that needs a call for each instruction.
  bool wants_all() const { return observer_ != nullptr && flow_ == nullptr; }
  /// Returns true if code may be translated. Translated code counts no events, does not call before(), and only records
  /// steps that may enter another function.
  bool allows_translation() const {
    if (counts_) return false;
    return observer_ == nullptr || (flow_ != nullptr && flow_ == decoded_.flow);
  }

  /// Calls the observer's before(). Returns true if the run continues. An observer must be set.
  bool continues() { return observer_->before(hart_); }
  /// Runs a block. If the block may reach the limit, or if `alone` is set, runs only its first instruction.
  void run_block(const Block& block, std::uint32_t stall, bool alone);
  void step();

  // These functions call the observer. If there is no observer, they have no effect.
  void trapped(const Trapped& trap) {
    account_.entered_trap();
    if (observer_ != nullptr) observer_->trapped(hart_, trap);
  }
  void flowed(std::span<const Flow> steps) const {
    if (observer_ != nullptr) observer_->flowed(hart_, steps);
  }
  void slept();
  void woke() {
    if (sleep_reported_) [[unlikely]]
      report_wake_up();
  }
  /// Must be called after a state was restored. `sleeping` is true if the core sleeps in that state.
  void restored(bool sleeping) {
    sleep_reported_ = observer_ != nullptr && sleeping;
    account_.restart();
  }

 private:
  void update_walk();
  void retire(Retired& instruction, std::uint32_t hidden);
  static bool is_reported(const Instruction* at, const QuietCode& quiet);
  const Instruction* next_reported(const Instruction* at, const Instruction* stop) const;
  const Instruction* walk(const Instruction* at, const Instruction* stop) override;
  Retired preview(std::uint32_t pc) const;
  void report_wake_up();

  const Hart& hart_;
  Execution& execution_;
  DecodedCode& decoded_;
  Interpreter& interpreter_;
  const RunLimit& limit_;
  Observer* observer_ = nullptr;
  const FlowMap* flow_ = nullptr;  // result of the observer's flow()
  CycleAccount account_;
  bool counts_ = false;
  bool sleep_reported_ = false;
};

}  // namespace mebots::soc
