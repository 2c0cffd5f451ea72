// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace mebots::master {

/// Returns the value references of the inputs that an FMU of FMI 3.0 for co-simulation accepts within a step:
/// continuous Float64 with intermediateUpdate. Empty if the FMU does not call back. `model` has elements in place of
/// arrays; the references are of whole arrays.
std::vector<std::uint32_t> intermediate_inputs(const modeldesc::ModelDescription& model);

/// The values of these inputs within a step: polynomials in time, by the derivatives of their sources. An array is set
/// only if all of its elements are set at the step's start.
class IntermediateInputs {
 public:
  /// Contains no inputs.
  IntermediateInputs() = default;
  explicit IntermediateInputs(const modeldesc::ModelDescription& model);

  bool empty() const { return wholes_.empty(); }
  /// Stores the values at the start of the next step. Other variables are ignored.
  void set(std::span<const ValueReference> references, std::span<const double> values);
  /// Stores derivatives at the start of the next step, after the values.
  void set_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                       std::span<const double> values);
  /// Starts a step. If no value was set since the last one, the polynomials continue.
  void start_step(double start_s);
  /// Returns the inputs with derivatives, and their values.
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
  std::map<ValueReference, Course> courses_;
  double start_s_ = 0;
  bool has_stepped_ = true;  // since the last value was set
};

}  // namespace mebots::master
