// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "model/run_course.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>

/// The error of the coupling in one step. Between two communication points an input follows a polynomial p (a constant
/// where no derivatives are known), and its source's output y takes another course. No FMU can see the difference.
namespace mebots::master {

/// An output over one step: a parabola through its ends and the end before, a line in the first step. What derivatives
/// an FMU gives is not used: they are of the order that the coupling's error has itself.
struct OutputCourse {
  std::optional<double> before = {};  ///< one step earlier than `first`
  double before_length_s = 0;         ///< of that step
  double first = 0;
  double last = 0;

  /// Coefficients of 1, tau and tau^2 over a step of this length [s].
  std::array<double, 3> coefficients(double length_s) const;
};

/// A Real input and the output that it is connected to, over the steps of the source.
class CoupledInput {
 public:
  CoupledInput(Ensemble& ensemble, const ResolvedConnection& connection);

  /// True if the source's output is that of this time. False if the source is in the middle of a longer step.
  bool is_reached(std::int64_t time_ns) const { return ensemble_->outputs_time_ns(output_.instance) == time_ns; }
  /// The source's output as the input would have it.
  double value() const { return factor_ * ensemble_->real(output_) + offset_; }
  const InputCourse& input() const { return input_; }
  /// The input's value at this time, in the reader's step that was taken last.
  double input_at(std::int64_t time_ns, const TimeGrid& grid) const;
  double factor() const { return factor_; }
  double offset() const { return offset_; }
  /// The power of the step with which the deviation falls.
  int order() const { return 1 + static_cast<int>(input_.derivatives.size()); }

  /// Begins a step of the source at its present output.
  void advance(std::int64_t time_ns, const TimeGrid& grid);
  std::optional<std::int64_t> start_ns() const { return start_ns_; }
  /// The output itself, from the start of the source's step to now.
  OutputCourse course() const;
  /// The integral of the input's distance from `value()` over the source's step that ends at this time, by Simpson's
  /// rule. In the middle of the step the output is on its parabola.
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

/// Two connections whose product is a power. With the effort e from A to B and the flow f from B to A, B takes e_in f
/// and A gives e f_in. So the integral of e_in f - e f_in was made on the way (Sadjina, Kyllingstad, Skjong, Pedersen
/// 2017, "Energy conservation and power bonds in co-simulations"). It is lost where it is negative.
class PowerBond {
 public:
  /// Throws InputError when the two are not connected Real inputs of two instances with the same step, one towards the
  /// other.
  PowerBond(const ResolvedSystem& system, Ensemble& ensemble, const BondDescription& description);

  /// The energies of one step.
  struct Energy {
    double made = 0;
    double passed = 0;    ///< in either direction
    double length_s = 0;  ///< of the step
  };
  /// Returns the energies of the step that ends at this point, or nullopt if no step of both instances ends there.
  std::optional<Energy> energy(const Point& point, const TimeGrid& grid) const;
  /// Begins a step of both instances, if one begins at this point.
  void advance(const Point& point, const TimeGrid& grid);

  const BondDescription& description() const { return *description_; }
  const std::string& unit() const { return unit_; }
  int order() const { return std::min(effort_.order(), flow_.order()); }
  void visit(state::Visitor& v);

 private:
  const BondDescription* description_;
  CoupledInput effort_;
  CoupledInput flow_;
  std::int64_t steps_ = 1;  // both instances' step, in steps of the system
  std::string unit_;
};

}  // namespace mebots::master
