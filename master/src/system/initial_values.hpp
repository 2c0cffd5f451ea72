// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "system/ensemble.hpp"

#include <optional>
#include <vector>

namespace mebots::master {

/// Takes values along the connections in initialisation mode until they stand still. Without a loop that takes as
/// many sweeps as the longest chain has links. A loop of Reals x = G(x) that sweeping does not settle is solved by
/// Newton's method with differences for derivatives. The loop is cut at as few inputs as a depth-first search finds
/// (the tearing method of equation-based tools), all else follows from these by sweeping.
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

  bool sweep(int sweeps, bool hold_cuts);
  void write(std::size_t instance, bool hold_cuts);
  bool standing_still(const std::vector<Banks>& before) const;
  bool driven_apart() const;
  std::vector<double> cut_values() const;
  bool newton();
  std::optional<std::vector<double>> residual(const std::vector<double>& x);
  [[noreturn]] void fail(const std::string& what) const;

  Ensemble& ensemble_;
  std::vector<Cut> cuts_;
  bool only_reals_ = true;  ///< every cut is at a Real input
  std::vector<double> held_;
};

}  // namespace mebots::master
