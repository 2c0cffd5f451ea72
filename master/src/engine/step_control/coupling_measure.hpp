// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/coupling_error.hpp"
#include "engine/ensemble.hpp"
#include "model/resolved_system.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace mebots::master {

/// Measures the error of a communication step, divided by its limit. The result is the largest value of all inputs and
/// bonds that step control measures. The error of an input is the integral of its deviation from the source over the
/// step. The error of a bond is the created energy. The limit is the tolerance times the maximum length of a step.
class CouplingMeasure {
 public:
  /// All arguments must outlive this object. Must be created before Ensemble::initialize(). Throws the same errors as
  /// PowerBond.
  CouplingMeasure(const ResolvedSystem& system, Ensemble& ensemble);

  struct Error {
    double over_tolerance = 0;
    int order = 2;                          ///< the power of the step with which it grows
    std::optional<std::size_t> worst = {};  ///< index of the input or bond in ResolvedStepControl::measured
  };
  /// Returns the error of the step that ends at `point`. The ensemble must have reached this point.
  Error error(const Point& point) const;
  /// Starts the next step at this point.
  void advance(const Point& point);

  void visit(state::Visitor& v);

 private:
  struct Item {
    CouplingTolerance tolerance;
    double nominal = 1;  // of an input
    std::optional<CoupledInput> input;
    std::optional<PowerBond> bond;
    double largest = 0;  // largest magnitude so far: the source's value or the bond's power

    void visit(state::Visitor& v);
  };
  /// The integral of an error over a step, and the magnitude to which the relative tolerance refers.
  struct Measured {
    double error = 0;
    double magnitude = 0;
  };

  std::optional<Measured> measure(const Item& item, const Point& point) const;

  TimeGrid grid_;
  double max_step_s_;
  std::vector<Item> items_;
};

}  // namespace mebots::master
