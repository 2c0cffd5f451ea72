// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"

#include <optional>
#include <vector>

namespace mebots::master {

/// Propagates values along the connections in initialisation mode until they no longer change. Each sweep reads the
/// outputs of instances whose inputs changed in the previous sweep, and then sets the connected inputs. Without a loop,
/// the number of sweeps is the length of the longest chain. If the Reals in a loop x = G(x) do not converge, Newton's
/// method with finite differences solves the loop. For this purpose, a depth-first search finds a few inputs that cut
/// all loops (tearing). All other values of the loops follow from these inputs.
class InitialValues {
 public:
  explicit InitialValues(Ensemble& ensemble);

  /// Propagates the initial values along the connections until they no longer change. Throws Error if the values in a
  /// loop do not converge; the text names the loop. Throws NotFiniteError if a value is NaN or infinite.
  void settle();

 private:
  struct Cut {
    std::size_t instance;
    std::size_t slot;  // index among the instance's Real inputs
  };

  /// A connection from an output of an instance.
  struct Link {
    ValueKind kind;
    std::size_t slot;  // index among the source instance's outputs of this kind
    std::size_t to;    // instance that has the input
    bool is_pointer;   // true for a part of an OSMP address, which an FMU may change at each call
  };
  struct Change {
    bool is_settled = true;           // true if no value differs by more than the tolerance
    std::vector<std::size_t> driven;  // instances whose inputs changed; sorted and without repetition after a sweep
  };

  bool sweep(int sweeps, bool hold_cuts);
  void read(std::size_t instance, Change& change);
  void write(std::size_t instance, bool hold_cuts);
  bool driven_apart() const;
  std::vector<double> cut_values() const;
  bool newton();
  std::optional<std::vector<double>> residual(const std::vector<double>& x);
  [[noreturn]] void fail(const std::string& what) const;

  Ensemble& ensemble_;
  std::vector<std::vector<Link>> links_;  ///< indexed by source instance
  std::vector<Cut> cuts_;
  bool only_reals_ = true;  ///< true if every cut is at a Real input
  std::vector<double> held_;
};

}  // namespace mebots::master
