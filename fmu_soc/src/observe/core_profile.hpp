// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/observer.hpp"
#include "observe/call_tree.hpp"
#include "observe/functions.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <vector>

namespace mebots::soc::observe {

/// Counts the costs of one hart for each function and call stack.
///
/// Stacks follow the calling convention: jal and jalr that write a link register (ra, t0) are calls. A jump through a
/// link register to a return address on the stack is a return. Any other step into another function replaces the
/// present function (tail call). A trap or interrupt has a frame until its mret. Sleep and time without supply also
/// have frames.
///
/// Energy: a cluster core gets the energy of its instructions and memory accesses, without that of its gated clock. The
/// fabric controller gets all other energy of the chip. The sum over the harts is therefore the energy of the chip.
class CoreProfile final : public Observer {
 public:
  /// `number` is the number of the hart in the chip. All harts share `functions`.
  CoreProfile(const Soc& soc, unsigned number, Functions& functions);

  void retired(const Hart& hart, const Retired& instruction) override;
  QuietCode quiet() const override;
  const FlowMap* flow() const override { return &functions_; }
  void flowed(const Hart& hart, std::span<const Flow> steps) override;
  void trapped(const Hart& hart, const Trapped& trap) override;
  void slept(const Hart& hart) override;
  void woke(const Hart& hart) override;
  void switched(const Hart& hart, bool on) override;

  /// Restarts the call stack after the chip was restored to an earlier state. The counts are kept.
  void restored() { start(); }
  /// Adds all costs up to now to the call tree. Must be called between two calls that run the chip.
  void settle();
  /// Adds all costs up to the end of the run to the call tree. If the last block of a cluster core ends after the
  /// chip's time, that core's costs end with the block.
  void finish();

  unsigned number() const { return number_; }
  const CallTree& tree() const { return tree_; }
  Cost total() const { return tree_.inclusive()[CallTree::kRoot]; }

 private:
  enum class Kind : std::uint8_t { function, trap, sleep, off };
  struct Frame {
    std::uint32_t node = 0;
    std::uint32_t place = 0;
    std::uint32_t return_address = 0;
    Kind kind = Kind::function;
  };

  struct Step {
    Op op;
    unsigned rd;
    unsigned rs1;
    std::uint32_t after;  // address after the first of the two instructions
    std::uint32_t next;
  };

  void start();
  bool runs() const { return soc_.is_on(number_) && !hart_.sleeping(); }
  Cost now() const;
  Cost now_of_chip() const;
  std::int64_t energy_fj(double chip_j) const;
  void charge(const Cost& now);
  void start_stack();
  void push(std::uint32_t place, std::uint32_t return_address, Kind kind);
  template <typename Now>
  void step(const Step& step, Now now);
  template <typename Now>
  void go_to(std::uint32_t address, Now now);
  template <typename Now>
  bool return_to(std::uint32_t address, Now now);
  void return_from_trap(std::uint32_t address);

  const Soc& soc_;
  const Hart& hart_;
  unsigned number_;
  Functions& functions_;
  CallTree tree_;
  std::vector<Frame> stack_;
  Cost charged_;
};

}  // namespace mebots::soc::observe
