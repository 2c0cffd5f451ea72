// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "model/run_course.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>

/// The coupling error of one step. Between two communication points, an input follows a polynomial p, which is constant
/// if no derivatives are known. The connected output y has other values. No FMU can detect this difference.
namespace mebots::master {

/// The course of an output over one step: a parabola through its values at both ends of the step and at the end of the
/// previous step. In the first step, the course is a line. The derivatives that the FMU provides are not used, because
/// their error is of the same order as the coupling error.
struct OutputCourse {
  std::optional<double> before = {};  ///< the value one step before `first`
  double before_length_s = 0;         ///< of that step
  double first = 0;
  double last = 0;

  /// Returns the coefficients of 1, tau and tau^2 for a step of length `length_s` [s].
  std::array<double, 3> coefficients(double length_s) const;
};

/// A Real input and its connected output, over the steps of the source.
class CoupledInput {
 public:
  CoupledInput(Ensemble& ensemble, const ResolvedConnection& connection);

  /// True if the source's output is known at this time. False if this time is inside a longer step of the source.
  bool is_reached(std::int64_t time_ns) const { return ensemble_->outputs_time_ns(output_.instance) == time_ns; }
  /// Returns the source's output in the input's unit.
  double value() const { return factor_ * ensemble_->real(output_) + offset_; }
  const InputCourse& input() const { return input_; }
  /// Returns the input's value at a time within the last step of the instance that reads it.
  double input_at(std::int64_t time_ns, const TimeGrid& grid) const;
  double factor() const { return factor_; }
  double offset() const { return offset_; }
  /// Returns the order of the deviation: the power of the step length to which it is proportional.
  int order() const { return 1 + static_cast<int>(input_.derivatives.size()); }

  /// Called when a step of the source starts. Stores the source's present output.
  void advance(std::int64_t time_ns, const TimeGrid& grid);
  std::optional<std::int64_t> start_ns() const { return start_ns_; }
  /// Returns the course of the output from the start of the source's step to the present time.
  OutputCourse course() const;
  /// Integrates the absolute difference between the input and the output by Simpson's rule, over the source's step that
  /// ends at this time. Within the step, the output follows its parabola.
  double deviation_integral(std::int64_t time_ns, const TimeGrid& grid) const;

  void visit(state::Visitor& v);

 private:
  const Ensemble* ensemble_;
  SignalId output_;
  double factor_;
  double offset_;
  InputCourse input_;
  std::optional<std::int64_t> start_ns_;  // of the source's step
  double first_ = 0;                      // output at start_ns_
  std::optional<double> before_;          // output one step earlier
  double before_length_s_ = 0;            // of that step
};

/// Two connections whose product is a power. The effort e is connected from A to B, the flow f from B to A. B receives
/// the power e_in f, and A delivers the power e f_in. Therefore the coupling creates the integral of e_in f - e f_in. A
/// negative value is a loss (Sadjina, Kyllingstad, Skjong, Pedersen 2017, "Energy conservation and power bonds in
/// co-simulations").
class PowerBond {
 public:
  /// Throws InputError if the bond does not name two connected Real inputs of two instances with the same step, one
  /// input in each direction.
  PowerBond(const ResolvedSystem& system, Ensemble& ensemble, const BondDescription& description);

  /// The energies of the bond in one step.
  struct Energy {
    double made = 0;      ///< created by the coupling; negative if lost
    double passed = 0;    ///< exchanged by A and B, absolute value
    double length_s = 0;  ///< of the step
  };
  /// Returns the energies of the step that ends at this point. Returns nullopt if no step of both instances ends there.
  std::optional<Energy> energy(const Point& point, const TimeGrid& grid) const;
  /// Starts a step of the bond, if a step of both instances starts at this point.
  void advance(const Point& point, const TimeGrid& grid);

  const BondDescription& description() const { return *description_; }
  const std::string& unit() const { return unit_; }
  int order() const { return std::min(effort_.order(), flow_.order()); }
  void visit(state::Visitor& v);

 private:
  const BondDescription* description_;
  CoupledInput effort_;
  CoupledInput flow_;
  std::int64_t steps_ = 1;  // the step of both instances, in steps of the system
  std::string unit_;
};

}  // namespace mebots::master
