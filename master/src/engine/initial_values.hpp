// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"

#include <optional>
#include <vector>

namespace mebots::master {

/// Propagates values along the connections in initialisation mode until they no longer change. Each sweep reads the
/// outputs of those instances whose inputs the sweep before has changed, and then sets the inputs that these outputs
/// drive. Without a loop there are as many sweeps as the longest chain has links. A loop of Reals x = G(x) that does
/// not settle is solved by Newton's method with differences for derivatives. The loop is cut at as few inputs as a
/// depth-first search finds (the tearing method of equation-based tools); all other values follow from these.
class InitialValues {
 public:
  explicit InitialValues(Ensemble& ensemble);

  /// Throws Error with the loop's path when no values settle, NotFiniteError for NaN or infinity.
  void settle();

 private:
  /// An input at which a loop is cut.
  struct Cut {
    std::size_t instance;
    std::size_t slot;  // among its Real inputs
  };

  /// A connection as seen from the instance that drives it.
  struct Link {
    ValueKind kind;
    std::size_t slot;  // among the driving instance's outputs of this kind
    std::size_t to;    // the driven instance
    bool is_pointer;   // part of an address, of which an FMU may return another one at each call
  };
  struct Change {
    bool is_settled = true;           // no value differs by more than the tolerance
    std::vector<std::size_t> driven;  // instances, in ascending order and without repetition after a sweep
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
  std::vector<std::vector<Link>> links_;  ///< by driving instance
  std::vector<Cut> cuts_;
  bool only_reals_ = true;  ///< every cut is at a Real input
  std::vector<double> held_;
};

}  // namespace mebots::master
