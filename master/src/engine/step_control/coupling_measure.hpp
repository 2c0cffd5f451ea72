// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/coupling_error.hpp"
#include "engine/ensemble.hpp"
#include "model/resolved_system.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace mebots::master {

/// Measures the error of a communication step over its tolerance: the largest of all inputs and bonds that the step
/// control measures. The error of an input is the integral of its deviation from the source, that of a bond the energy
/// that was made. So it is what the step adds to the error of the run. The tolerance is that of a step of the greatest
/// length.
class CouplingMeasure {
 public:
  /// All must outlive this object. Before Ensemble::initialize(). Throws as PowerBond does.
  CouplingMeasure(const ResolvedSystem& system, Ensemble& ensemble);

  struct Error {
    double over_tolerance = 0;
    int order = 2;                          ///< with which power of the step it grows
    std::optional<std::size_t> worst = {};  ///< of which input or bond, by ResolvedStepControl::measured
  };
  /// The error of the step that ends at this point, which the ensemble has reached.
  Error error(const Point& point) const;
  /// Begins the next step at this point.
  void advance(const Point& point);

  void visit(state::Visitor& v);

 private:
  struct Item {
    CouplingTolerance tolerance;
    double nominal = 1;  // of an input
    std::optional<CoupledInput> input;
    std::optional<PowerBond> bond;
    double largest = 0;  // magnitude so far: the source's value, or the bond's power

    void visit(state::Visitor& v);
  };
  /// An integral over the step, and the magnitude that the relative tolerance counts of.
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
