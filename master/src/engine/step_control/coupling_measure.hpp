// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/coupling_error.hpp"
#include "engine/ensemble.hpp"
#include "model/resolved_system.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace mebots::master {

/// Measures the error of a communication step relative to the tolerance. Returns the largest ratio of all measured
/// inputs and bonds. The error of an input is the integral of its deviation from the source over the step. The error of
/// a bond is the energy that the coupling created. The limit is the tolerance times the maximum length of a step.
class CouplingMeasure {
 public:
  /// All arguments must outlive this object. Must be created before Ensemble::initialize(). Throws InputError if a
  /// measured power bond is invalid (see PowerBond).
  CouplingMeasure(const ResolvedSystem& system, Ensemble& ensemble);

  struct Error {
    double over_tolerance = 0;
    int order = 2;                          ///< the error is proportional to this power of the step length
    std::optional<std::size_t> worst = {};  ///< index of the input or bond in ResolvedStepControl::measured
  };
  /// Returns the coupling error of the communication step that ends at `point`. The ensemble must contain the outputs
  /// at this point.
  Error error(const Point& point) const;
  /// Stores the outputs at `point`, where the next communication step starts.
  void advance(const Point& point);

  void visit(state::Visitor& v);

 private:
  struct Item {
    CouplingTolerance tolerance;
    double nominal = 1;
    std::optional<CoupledInput> input;
    std::optional<PowerBond> bond;
    double largest = 0;  // largest magnitude so far of the output or of the bond's power

    void visit(state::Visitor& v);
  };
  /// The coupling error of a step, and the magnitude to which the relative tolerance applies.
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
