// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/continuous_instance.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::master {

/// Identifies a Real variable of one member of a continuous system.
struct MemberVariable {
  std::size_t member = 0;
  ValueReference reference = 0;

  auto operator<=>(const MemberVariable&) const = default;
};

/// A connection from a Real output of one member to a continuous Real input of another member. The input is factor *
/// value + offset. If several wires end at an input, it is the sum of these terms.
struct Wire {
  MemberVariable from;
  MemberVariable to;
  double factor = 1;
  double offset = 0;
  /// Value references of the inputs on which the output directly depends. If nullopt, it may depend on all inputs.
  std::optional<std::vector<ValueReference>> dependencies = {};
  std::string from_name = {};  ///< name for messages, "instance.variable"
  std::string to_name = {};
};

/// Evaluates the connections between the members of a continuous system (wires). They are ordered so that every output
/// is read after the inputs on which it depends were set. Outputs are read in stages: in a stage, one call reads all
/// outputs of one member. Wires in a loop, and wires that depend on a loop, are evaluated together until no value
/// changes.
class Wiring {
 public:
  /// `members` must outlive the wiring.
  Wiring(std::vector<ContinuousInstance*> members, const std::vector<Wire>& wires);

  /// Transfers the values of all wires. If a loop does not converge, throws Error (algebraic_loop) that contains the
  /// path of the loop.
  Evaluation evaluate();
  bool has_loop() const { return !loop_.reads.empty(); }
  bool empty() const { return stages_.empty() && !has_loop(); }

  /// Returns the values of the inputs. set_loop_start() requires values in the same order.
  std::span<const double> inputs() const { return inputs_; }
  /// Sets the values at which the iteration of loops starts in each evaluation. As these values are fixed, results do
  /// not depend on earlier evaluations.
  void set_loop_start(std::span<const double> inputs) { loop_start_.assign(inputs.begin(), inputs.end()); }

  /// Computes how all derivatives change if one state of a member changes by 1. The derivatives of member `i` start at
  /// the index first_states[i]. Must be called only if there is no loop and all members provide directional
  /// derivatives.
  void propagate(std::size_t member, std::size_t state, std::span<const std::size_t> first_states,
                 std::span<double> derivatives);

 private:
  /// The outputs of a member that one call reads. Their values are adjacent.
  struct Read {
    std::size_t member = 0;
    std::vector<ValueReference> references = {};
    std::size_t first = 0;
  };
  /// The inputs of a member that one call sets. Their values are adjacent.
  struct Write {
    std::size_t member = 0;
    std::vector<ValueReference> references = {};
    std::size_t first = 0;
  };
  struct Stage {
    std::vector<Read> reads = {};
    std::vector<Write> writes = {};
  };
  /// A term of the sum that determines an input: factor * output + offset.
  struct Term {
    std::size_t output;
    double factor;
    double offset;
  };
  class Builder;

  /// The changes of a member's inputs and states in propagate().
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
