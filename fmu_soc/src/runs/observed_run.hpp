// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "hart/interpreter.hpp"
#include "hart/observer.hpp"
#include "runs/decoded_code.hpp"

#include <cstdint>
#include <span>

namespace mebots::soc {

/// Runs a core that somebody watches: as it runs otherwise, with a pause behind every instruction of which the observer
/// wants to be told. All functions need an observer unless stated.
class ObservedRun final : private BlockWalk {
 public:
  ObservedRun(const Hart& hart, Execution& execution, DecodedCode& decoded, Interpreter& interpreter,
              const RunLimit& limit)
      : hart_(hart), execution_(execution), decoded_(decoded), interpreter_(interpreter), limit_(limit) {}

  /// Who watches from now on, or null. `sleeping`: whether the core does now.
  void observe(Observer* observer, bool sleeping);
  /// Null without one.
  Observer* observer() const { return observer_; }
  /// Whether there is an observer, and it wants to be asked before each instruction.
  bool wants_all() const { return observer_ != nullptr && flow_ == nullptr; }
  /// Whether translated code tells enough, if there is an observer. It does not serve one who wants to be asked, nor
  /// one whose steps it does not note.
  bool allows_translation() const { return observer_ == nullptr || (flow_ != nullptr && flow_ == decoded_.flow); }

  /// Whether the run goes on with the instruction at the pc.
  bool goes_on() { return observer_->before(hart_); }
  /// A block, or only its first instruction where the block may reach the limit. `alone`: only that in any case.
  void run_block(const Block& block, std::uint32_t stall, bool alone);
  void step();

  // Told to the observer, if there is one.
  void trapped(const Trapped& trap) const {
    if (observer_ != nullptr) observer_->trapped(hart_, trap);
  }
  void flowed(std::span<const Flow> steps) const {
    if (observer_ != nullptr) observer_->flowed(hart_, steps);
  }
  void slept();
  void woke() {
    if (knows_of_sleep_) [[unlikely]]
      tell_of_waking();
  }
  /// A state has been restored, of a core that sleeps or not.
  void restored(bool sleeping) { knows_of_sleep_ = observer_ != nullptr && sleeping; }

 private:
  static bool is_told(const Instruction* at, const QuietCode& quiet);
  const Instruction* next_told(const Instruction* at, const Instruction* stop) const;
  const Instruction* walk(const Instruction* at, const Instruction* stop) override;
  Retired foresee(std::uint32_t pc) const;
  void tell_of_waking();

  const Hart& hart_;
  Execution& execution_;
  DecodedCode& decoded_;
  Interpreter& interpreter_;
  const RunLimit& limit_;
  Observer* observer_ = nullptr;
  const FlowMap* flow_ = nullptr;  // of the observer
  bool knows_of_sleep_ = false;
};

}  // namespace mebots::soc
