// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "model/run_course.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>

/// Measures the coupling error of one step: the difference between an output and the polynomial that the connected
/// input follows during the step.
namespace mebots::master {

/// Approximates an output during one step by the parabola through three values: those at both ends of the step and at
/// the end of the previous step. In the first step, the approximation is a line. Does not use derivatives from the FMU,
/// because their error has the same order as the coupling error.
struct OutputCourse {
  std::optional<double> before = {};  ///< value one step before `first`
  double before_length_s = 0;         ///< length of the step before `first` [s]
  double first = 0;
  double last = 0;

  /// Returns the coefficients of 1, tau and tau^2, where tau is the time since the start of the step.
  std::array<double, 3> coefficients(double length_s) const;
};

/// A Real input and its connected output. Stores the output's values at the start and end of each step of the output's
/// instance.
class CoupledInput {
 public:
  CoupledInput(Ensemble& ensemble, const ResolvedConnection& connection);

  /// True if the output's latest value is the value at this time. False within a longer step of the output's instance.
  bool is_reached(std::int64_t time_ns) const { return ensemble_->outputs_time_ns(output_.instance) == time_ns; }
  /// Returns the latest output value, converted to the input's unit.
  double value() const { return factor_ * ensemble_->real(output_) + offset_; }
  const InputCourse& input() const { return input_; }
  /// Returns the input's value at a time within the last step of the input's instance.
  double input_at(std::int64_t time_ns, const TimeGrid& grid) const;
  double factor() const { return factor_; }
  double offset() const { return offset_; }
  /// Returns the order of the coupling error: the error is proportional to this power of the step length.
  int order() const { return 1 + static_cast<int>(input_.derivatives.size()); }

  /// Stores the latest output value. Must be called at the start of each step of the output's instance.
  void advance(std::int64_t time_ns, const TimeGrid& grid);
  std::optional<std::int64_t> start_ns() const { return start_ns_; }
  /// Returns the approximation of the output from start_ns() to the latest output value.
  OutputCourse course() const;
  /// Returns the integral of |input - output| over the step of the output's instance that ends at `time_ns`.
  /// Approximates the output by a parabola and integrates by Simpson's rule. If the last step of the input's instance
  /// started at another time than this step, returns |input - output| at `time_ns`, multiplied by the length of this
  /// step.
  double deviation_integral(std::int64_t time_ns, const TimeGrid& grid) const;

  void visit(state::Visitor& v);

 private:
  const Ensemble* ensemble_;
  SignalId output_;
  double factor_;
  double offset_;
  InputCourse input_;
  std::optional<std::int64_t> start_ns_;  // start of the current step of the output's instance
  double first_ = 0;                      // output value at start_ns_
  std::optional<double> before_;          // output value one step before start_ns_
  double before_length_s_ = 0;            // length of the step before start_ns_ [s]
};

/// A power bond: two connections in opposite directions whose values have a power as product. The effort e is connected
/// from instance A to B, the flow f from B to A. A delivers the power e f_in, and B receives the power e_in f, where
/// e_in and f_in are input values. The coupling therefore creates the integral of e_in f - e f_in; a negative value is
/// a loss. Source: Sadjina, Kyllingstad, Skjong, Pedersen 2017, "Energy conservation and power bonds in
/// co-simulations".
class PowerBond {
 public:
  /// Throws InputError unless the description names two connected Real inputs, one in each direction between two
  /// instances, and both instances have the same step.
  PowerBond(const ResolvedSystem& system, Ensemble& ensemble, const BondDescription& description);

  struct Energy {
    double made = 0;    ///< energy that the coupling created; negative if the coupling lost energy
    double passed = 0;  ///< absolute value of the energy that A and B exchanged
    double length_s = 0;
  };
  /// Returns the energies of the step that ends at this point. Returns nullopt if no step of the two instances ends at
  /// this point.
  std::optional<Energy> energy(const Point& point, const TimeGrid& grid) const;
  /// Stores the outputs at this point if a step of the two instances starts here.
  void advance(const Point& point, const TimeGrid& grid);

  const BondDescription& description() const { return *description_; }
  const std::string& unit() const { return unit_; }
  int order() const { return std::min(effort_.order(), flow_.order()); }
  void visit(state::Visitor& v);

 private:
  const BondDescription* description_;
  CoupledInput effort_;
  CoupledInput flow_;
  std::int64_t steps_ = 1;  // length of the instances' step, in steps of the grid
  std::string unit_;
};

}  // namespace mebots::master
