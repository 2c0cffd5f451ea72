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

/// The inputs that an FMU of FMI 3.0 for co-simulation accepts within a step: continuous Float64 with
/// intermediateUpdate. Within a step, the value of an input is a polynomial in time. Its coefficients come from the
/// derivatives of the output that is connected to the input. An array is set only if all of its elements are set at the
/// step's start.
class IntermediateInputs {
 public:
  /// Contains no inputs.
  IntermediateInputs() = default;
  /// `model` has elements in place of arrays. Contains no inputs if the FMU does not call the master within steps.
  explicit IntermediateInputs(const modeldesc::ModelDescription& model);

  /// Returns the value references for FMU calls. An array has one reference.
  std::vector<std::uint32_t> references() const;
  bool empty() const { return wholes_.empty(); }
  /// Stores the values at the start of the next step. Other variables are ignored.
  void set(std::span<const ValueReference> references, std::span<const double> values);
  /// Stores derivatives at the start of the next step, after the values.
  void set_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                       std::span<const double> values);
  /// Starts a step. If no value was set since the last step, the polynomials continue.
  void start_step(double start_s);
  /// Returns the FMU's value references of the inputs with derivatives, and the values at `time_s`.
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
  std::set<ValueReference> elements_;  // of all wholes
  std::map<ValueReference, Course> courses_;
  double start_s_ = 0;
  bool has_stepped_ = true;  // since the last value was set
};

}  // namespace mebots::master
