// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// What the coupling of a run cost in accuracy. Between two communication points an input follows a polynomial p (a
/// constant where no derivatives are known), and its source's output y goes its own way. The difference is the
/// coupling's error, which no FMU can see.
namespace mebots::master {

/// An output over one step: a parabola through its ends and the end before, a line in the first step. What derivatives
/// an FMU gives is not used: they are of the order that the coupling's error has itself.
struct OutputCourse {
  std::optional<double> before;  ///< one step earlier than `first`
  double first = 0;
  double last = 0;

  /// Coefficients of 1, tau and tau^2 over a step of this length [s].
  std::array<double, 3> coefficients(double length_s) const;
};

/// How far one continuous Real input was from its source, in the input's unit. That is p - y at all points that the
/// source reached in a step of the reader, and at the step's start.
class InputDeviation {
 public:
  InputDeviation(const ResolvedSystem& system, Ensemble& ensemble, const ResolvedConnection& connection);

  void reached(std::int64_t time_ns, const TimeGrid& grid);
  void visit(state::Visitor& v);

  const std::string& input() const { return input_; }
  /// Root mean square of the deviation over the range of the source's value; 0 while that stands still.
  double relative() const;
  /// With which power of the step the deviation falls.
  int order() const { return 1 + static_cast<int>(course_.derivatives.size()); }
  nlohmann::ordered_json json() const;

 private:
  void take(double deviation, std::int64_t time_ns);

  std::string input_;
  std::string source_;
  std::string unit_;
  const Ensemble* ensemble_;
  SignalId output_;
  double factor_;
  double offset_;
  InputCourse course_;

  double last_value_ = 0;  // of the source, as the input would have it, at last_time_ns_
  std::optional<std::int64_t> last_time_ns_;
  double least_ = 0;
  double most_ = 0;
  double squares_ = 0;
  std::int64_t count_ = 0;
  double largest_ = 0;
  std::int64_t largest_at_ns_ = 0;
};

/// The energy that the coupling made in one power bond. With the effort e from A to B and the flow f from B to A, B
/// takes e_in f and A gives e f_in. So the integral of e_in f - e f_in was made on the way (Sadjina, Kyllingstad,
/// Skjong, Pedersen 2017, "Energy conservation and power bonds in co-simulations"). It is lost where it is negative.
class BondEnergy {
 public:
  /// Throws InputError when the two are not connected Real inputs of two instances with the same step, one towards the
  /// other.
  BondEnergy(const ResolvedSystem& system, Ensemble& ensemble, const BondDescription& description);

  void reached(const Point& point, const TimeGrid& grid);
  void visit(state::Visitor& v);

  const BondDescription& description() const { return *description_; }
  double made() const { return made_; }
  double passed() const { return passed_; }
  /// The most that was made or lost at any point, over all that passed.
  double relative() const { return passed_ > 0 ? largest_ / passed_ : 0; }
  int order() const;
  nlohmann::ordered_json json() const;

 private:
  /// One of the two connections: its source's output and what its reader has.
  struct Half {
    SignalId output;
    double factor;
    double offset;
    InputCourse course;
    OutputCourse step;

    void visit(state::Visitor& v);
  };

  Half half(const ResolvedSystem& system, Ensemble& ensemble, const VariableName& input) const;

  const BondDescription* description_;
  const Ensemble* ensemble_;
  std::string unit_;
  std::vector<Half> halves_;              // effort and flow
  std::int64_t steps_ = 1;                // both instances' step, in steps of the system
  std::optional<std::int64_t> start_ns_;  // of the step that goes on
  double made_ = 0;
  double passed_ = 0;
  double largest_ = 0;
};

/// The report: per continuous Real connection its deviation, per bond its energy.
class Coupling final : public Observer {
 public:
  /// Throws InputError for bonds that are none.
  Coupling(const ResolvedSystem& system, Ensemble& ensemble);

  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "coupling"; }

  /// Where a limit is exceeded, with the communication step that would do.
  std::vector<std::string> warnings() const;
  nlohmann::ordered_json json() const;

 private:
  std::optional<double> input_limit_;
  TimeGrid grid_;
  double step_s_;
  std::vector<InputDeviation> inputs_;
  std::vector<BondEnergy> bonds_;
};

/// The step of 1, 2 or 5 times a power of ten [s] at which an error that falls with this power of the step is below the
/// limit; `relative` is the error at `step_s`.
double step_for(double relative, double limit, int order, double step_s);

}  // namespace mebots::master
