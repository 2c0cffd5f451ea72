// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/observer.hpp"
#include "observe/call_tree.hpp"
#include "observe/functions.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <vector>

namespace mebots::soc::observe {

/// Cost of one hart by function and call stack.
///
/// Stacks follow the calling convention: jal and jalr that write a link register (ra, t0) are calls. A jump through
/// one that meets a return address of the stack is a return to it. Any other way into another function takes the place
/// of the function that it comes from (a tail call). A trap or interrupt is a frame of its own until its mret; so are
/// sleep and having no supply.
///
/// Energy: a core of the cluster has what its instructions and accesses take, over what it takes with its clock gated.
/// All else of the chip (its other parts, leakage, clock trees, DMA, refills of the cluster's cache) is the fabric
/// controller's. So all harts together have the energy of the chip.
class CoreProfile final : public Observer {
 public:
  /// `number` as the chip numbers its harts. `functions` are those of all harts.
  CoreProfile(const Soc& soc, unsigned number, Functions& functions);

  void retired(const Hart& hart, const Retired& instruction) override;
  QuietCode quiet() const override;
  const FlowMap* flow() const override { return &functions_; }
  void flowed(const Hart& hart, std::span<const Flow> steps) override;
  void trapped(const Hart& hart, const Trapped& trap) override;
  void slept(const Hart& hart) override;
  void woke(const Hart& hart) override;
  void switched(const Hart& hart, bool on) override;

  /// The chip was put into an earlier state: what has been counted stays, stacks start anew.
  void restored() { start(); }
  /// Counts up to now, between two steps of a run that goes on.
  void settle();
  /// Counts up to now: time and energy of the chip, of a core of the cluster at least to the end of its last block.
  void finish();

  unsigned number() const { return number_; }
  const CallTree& tree() const { return tree_; }
  /// What the tree has counted; equal to what the run has, to the last unit.
  Cost total() const { return tree_.inclusive()[CallTree::kRoot]; }

 private:
  enum class Kind : std::uint8_t { function, trap, sleep, off };
  struct Frame {
    std::uint32_t node = 0;
    std::uint32_t place = 0;
    std::uint32_t return_address = 0;
    Kind kind = Kind::function;
  };

  /// From one instruction to the next.
  struct Step {
    Op op;
    unsigned rd;
    unsigned rs1;
    std::uint32_t after;  // address behind the instruction
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
