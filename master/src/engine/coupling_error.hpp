// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "model/run_course.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>

/// Measures the coupling error of one step. Between two communication points, an input follows a polynomial p, which is
/// constant if no derivatives are known. The connected output y differs from p, and no FMU can detect this difference.
namespace mebots::master {

/// Approximates an output during one step by a parabola through its values at both ends of the step and at the end of
/// the previous step. In the first step, the approximation is a line. Ignores derivatives that the FMU provides,
/// because their error has the same order as the coupling error.
struct OutputCourse {
  std::optional<double> before = {};  ///< the value one step before `first`
  double before_length_s = 0;         ///< length of the step before `first`
  double first = 0;
  double last = 0;

  /// Returns the coefficients of 1, tau and tau^2 for a step of length `length_s` [s].
  std::array<double, 3> coefficients(double length_s) const;
};

/// A Real input and the output that is connected to it. Stores the output's values at the ends of the source's steps.
class CoupledInput {
 public:
  CoupledInput(Ensemble& ensemble, const ResolvedConnection& connection);

  /// True if the source's output is known at this time. False if this time is inside a longer step of the source.
  bool is_reached(std::int64_t time_ns) const { return ensemble_->outputs_time_ns(output_.instance) == time_ns; }
  /// Returns the source's output, converted to the input's unit.
  double value() const { return factor_ * ensemble_->real(output_) + offset_; }
  const InputCourse& input() const { return input_; }
  /// Returns the input's value at a time within the last step of the instance that reads it.
  double input_at(std::int64_t time_ns, const TimeGrid& grid) const;
  double factor() const { return factor_; }
  double offset() const { return offset_; }
  /// Returns the order of the deviation: the power of the step length to which it is proportional.
  int order() const { return 1 + static_cast<int>(input_.derivatives.size()); }

  /// Stores the source's current output. Must be called when a step of the source starts.
  void advance(std::int64_t time_ns, const TimeGrid& grid);
  std::optional<std::int64_t> start_ns() const { return start_ns_; }
  /// Returns the course of the output from the start of the source's step to the present time.
  OutputCourse course() const;
  /// Returns the integral of the absolute difference between the input and the output over the source's step that ends
  /// at this time. Approximates the output by its parabola and integrates by Simpson's rule. If the reader's step did
  /// not start together with the source's step, returns the difference at the end times the step's length.
  double deviation_integral(std::int64_t time_ns, const TimeGrid& grid) const;

  void visit(state::Visitor& v);

 private:
  const Ensemble* ensemble_;
  SignalId output_;
  double factor_;
  double offset_;
  InputCourse input_;
  std::optional<std::int64_t> start_ns_;  // start of the source's current step
  double first_ = 0;                      // value of the output at start_ns_
  std::optional<double> before_;          // value of the output one step earlier
  double before_length_s_ = 0;            // length of the step before start_ns_ [s]
};

/// Two connections whose values have a power as product. The effort e is connected from instance A to B, the flow f
/// from B to A. B receives the power e_in f, and A delivers the power e f_in. Therefore the coupling creates the
/// integral of e_in f - e f_in; a negative value is a loss (Sadjina, Kyllingstad, Skjong, Pedersen 2017, "Energy
/// conservation and power bonds in co-simulations").
class PowerBond {
 public:
  /// Throws InputError unless the description names two connected Real inputs, one in each direction between two
  /// instances. Both instances must have the same step.
  PowerBond(const ResolvedSystem& system, Ensemble& ensemble, const BondDescription& description);

  /// The energies that a bond created and exchanged in one step.
  struct Energy {
    double made = 0;      ///< energy that the coupling created; negative if energy was lost
    double passed = 0;    ///< absolute value of the energy that A and B exchanged
    double length_s = 0;  ///< length of the step [s]
  };
  /// Returns the energies of the step that ends at this point. Returns nullopt if no step of the two instances ends
  /// there.
  std::optional<Energy> energy(const Point& point, const TimeGrid& grid) const;
  /// Starts a step of the bond if a step of the two instances starts at this point.
  void advance(const Point& point, const TimeGrid& grid);

  const BondDescription& description() const { return *description_; }
  const std::string& unit() const { return unit_; }
  int order() const { return std::min(effort_.order(), flow_.order()); }
  void visit(state::Visitor& v);

 private:
  const BondDescription* description_;
  CoupledInput effort_;
  CoupledInput flow_;
  std::int64_t steps_ = 1;  // length of both instances' step, as a number of steps of the system
  std::string unit_;
};

}  // namespace mebots::master
