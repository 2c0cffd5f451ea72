// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace mebots::master {

/// The inputs that a co-simulation FMU of FMI 3.0 accepts within a step: continuous Float64 with the attribute
/// intermediateUpdate. Within a step, such an input is a polynomial in time. Its coefficients are computed from the
/// derivatives of the connected output. An array is set within a step only if all of its elements are set at the start
/// of the step.
class IntermediateInputs {
 public:
  IntermediateInputs() = default;
  /// In `model`, arrays must be replaced by their elements. The object has no inputs if the FMU does not call the
  /// master within steps.
  explicit IntermediateInputs(const modeldesc::ModelDescription& model);

  /// Returns the value references of the inputs in the FMU. An array has one value reference.
  std::vector<std::uint32_t> references() const;
  bool empty() const { return wholes_.empty(); }
  /// Stores the values of inputs at the start of the next step. Ignores other variables.
  void set(std::span<const ValueReference> references, std::span<const double> values);
  /// Stores the derivatives of inputs at the start of the next step. Must be called after set().
  void set_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                       std::span<const double> values);
  /// Starts a step. If no value was set since the previous step, the polynomials of that step continue.
  void start_step(double start_s);
  /// Returns the value references in the FMU of all inputs that have derivatives, and the values of these inputs at
  /// `time_s`. Includes an array only if all of its elements are set.
  std::pair<std::vector<std::uint32_t>, std::vector<double>> values_at(double time_s) const;

 private:
  struct Whole {
    std::uint32_t reference = 0;
    std::vector<ValueReference> elements;
  };
  struct Course {
    double value = 0;
    std::vector<double> derivatives = {};
  };

  void begin_point();

  std::vector<Whole> wholes_;
  std::set<ValueReference> elements_;  // elements of all entries in `wholes_`
  std::map<ValueReference, Course> courses_;
  double start_s_ = 0;
  bool has_stepped_ = true;  // true if no value was set since the last step
};

}  // namespace mebots::master
