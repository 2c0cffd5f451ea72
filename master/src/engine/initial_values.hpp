// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"

#include <optional>
#include <vector>

namespace mebots::master {

/// Propagates values along the connections in initialisation mode until they no longer change. Each sweep reads the
/// outputs of the instances whose inputs the previous sweep changed, and then sets the connected inputs. If there is no
/// loop, the number of sweeps is the length of the longest chain. If the Reals in a loop x = G(x) do not converge,
/// solves the loop by Newton's method with finite differences. The loop is cut at a few inputs, which a depth-first
/// search finds (tearing, as in equation-based tools). All other values in the loop result from the values of these
/// inputs.
class InitialValues {
 public:
  explicit InitialValues(Ensemble& ensemble);

  /// Propagates the values. Throws Error that names the loop if the values do not converge. Throws NotFiniteError if a
  /// value is NaN or infinite.
  void settle();

 private:
  /// An input at which a loop is cut.
  struct Cut {
    std::size_t instance;
    std::size_t slot;  // index among the instance's Real inputs
  };

  /// A connection, stored with the instance that has the output.
  struct Link {
    ValueKind kind;
    std::size_t slot;  // index among the source instance's outputs of this kind
    std::size_t to;    // instance that has the input
    bool is_pointer;   // true for a part of an address, which an FMU may change at each call
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
