// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/continuous_instance.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// Identifies a Real variable of a member of a continuous system.
struct MemberVariable {
  std::size_t member = 0;
  ValueReference reference = 0;

  auto operator<=>(const MemberVariable&) const = default;
};

/// A connection from a Real output to a continuous Real input of another member. The input is factor * output + offset.
/// Several wires to one input add up.
struct Wire {
  MemberVariable from;
  MemberVariable to;
  double factor = 1;
  double offset = 0;
  /// Value references of the inputs on which the output directly depends. If nullopt, it may depend on all inputs.
  std::optional<std::vector<ValueReference>> dependencies = {};
  std::string from_name = {};  ///< "instance.variable", for messages
  std::string to_name = {};
};

/// Evaluates the connections (wires) between the members of a continuous system. Every output is read after the inputs
/// on which it depends are set. Outputs are read in stages; in a stage, one call per member reads outputs. Wires in
/// loops, and wires that depend on loops, are evaluated repeatedly until no value changes.
class Wiring {
 public:
  /// `members` must outlive the wiring.
  Wiring(std::vector<ContinuousInstance*> members, const std::vector<Wire>& wires);

  /// Transfers the values of all wires. Throws Error (algebraic_loop) with the path of the loop if a loop does not
  /// converge.
  Evaluation evaluate();
  bool has_loop() const { return !loop_.reads.empty(); }
  bool empty() const { return stages_.empty() && !has_loop(); }

  /// Returns the input values, in the order that set_loop_start() requires.
  std::span<const double> inputs() const { return inputs_; }
  /// Sets the start values for the iteration of loops. With fixed start values, results do not depend on earlier
  /// evaluations.
  void set_loop_start(std::span<const double> inputs) { loop_start_.assign(inputs.begin(), inputs.end()); }

  /// Computes the change of all derivatives if one state of a member changes by 1. In `derivatives`, those of member
  /// `i` start at the index first_states[i]. Requires that there is no loop and that all members provide directional
  /// derivatives.
  void propagate(std::size_t member, std::size_t state, std::span<const std::size_t> first_states,
                 std::span<double> derivatives);

 private:
  /// A call that reads outputs of a member. `first` is the index of its first value in outputs_.
  struct Read {
    std::size_t member = 0;
    std::vector<ValueReference> references = {};
    std::size_t first = 0;
  };
  /// A call that sets inputs of a member. `first` is the index of its first value in inputs_.
  struct Write {
    std::size_t member = 0;
    std::vector<ValueReference> references = {};
    std::size_t first = 0;
  };
  struct Stage {
    std::vector<Read> reads = {};
    std::vector<Write> writes = {};
  };
  /// A term factor * output + offset of an input.
  struct Term {
    std::size_t output;
    double factor;
    double offset;
  };
  class Builder;

  /// The inputs and states of a member that change (`knowns`), and their changes (`seed`).
  struct Change {
    std::vector<ValueReference> knowns = {};
    std::vector<double> seed = {};
  };

  Evaluation read(const Stage& stage);
  void collect(const Stage& stage);
  Evaluation write(const Stage& stage);
  Evaluation settle_loop();
  void change_inputs(const Stage& stage, std::span<const double> output_changes, std::vector<Change>& changes) const;

  std::vector<ContinuousInstance*> members_;
  std::vector<Stage> stages_;
  Stage loop_;
  std::string loop_path_;
  std::vector<double> outputs_;
  std::vector<double> inputs_;
  std::vector<std::vector<Term>> terms_;  // indexed by input
  std::vector<double> loop_start_;
};

}  // namespace mebots::master
