// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/coupling_error.hpp"
#include "engine/ensemble.hpp"
#include "record/observer.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Measures the errors that co-simulation causes by exchanging values only at communication points.
namespace mebots::master {

/// Measures the deviation of a continuous Real input from the connected output. Within a step, the input follows a
/// polynomial; the deviation is the polynomial minus the output, in the unit of the input. Measures at the start of the
/// input's step and at all points that the output reaches within this step.
class InputDeviation {
 public:
  InputDeviation(const ResolvedSystem& system, Ensemble& ensemble, const ResolvedConnection& connection);

  void reached(std::int64_t time_ns, const TimeGrid& grid);
  void visit(state::Visitor& v);

  const std::string& input() const { return input_; }
  /// Returns the root mean square of the deviation, relative to the range of the output. Returns 0 if the range is 0.
  double relative() const;
  int order() const { return coupled_.order(); }
  nlohmann::ordered_json json() const;

 private:
  void take(double deviation, std::int64_t time_ns);

  std::string input_;
  std::string source_;
  std::string unit_;
  CoupledInput coupled_;

  double last_value_ = 0;  // output at last_time_ns_, in the unit of the input
  std::optional<std::int64_t> last_time_ns_;
  double least_ = 0;
  double most_ = 0;
  double squares_ = 0;
  std::int64_t count_ = 0;
  double largest_ = 0;
  std::int64_t largest_at_ns_ = 0;
};

/// Measures the energy that the coupling of a power bond creates.
class BondEnergy {
 public:
  /// Throws InputError if the bond is invalid (see PowerBond).
  BondEnergy(const ResolvedSystem& system, Ensemble& ensemble, const BondDescription& description)
      : bond_(system, ensemble, description) {}

  void reached(const Point& point, const TimeGrid& grid);
  void visit(state::Visitor& v);

  const BondDescription& description() const { return bond_.description(); }
  double made() const { return made_; }
  double passed() const { return passed_; }
  /// Returns the largest energy created or lost so far, relative to the exchanged energy.
  double relative() const { return passed_ > 0 ? largest_ / passed_ : 0; }
  int order() const { return bond_.order(); }
  nlohmann::ordered_json json() const;

 private:
  PowerBond bond_;
  double made_ = 0;
  double passed_ = 0;
  double largest_ = 0;
};

/// Reports the deviation of each connected continuous Real input and the energy that each bond creates.
class Coupling final : public Observer {
 public:
  /// Throws InputError if a bond is invalid.
  Coupling(const ResolvedSystem& system, Ensemble& ensemble);

  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "coupling"; }

  /// Returns a text for each limit in the section `coupling` that the run exceeded. The text suggests a step that meets
  /// the limit, or a setting of step control.
  std::vector<std::string> warnings() const;
  nlohmann::ordered_json json() const;

 private:
  std::string advice(double relative, double limit, int order) const;

  std::optional<double> input_limit_;
  const SystemDescription* system_;
  TimeGrid grid_;
  std::vector<InputDeviation> inputs_;
  std::vector<BondEnergy> bonds_;
};

/// Returns a step of 1, 2 or 5 times a power of ten [s] at which the error stays below the limit. `relative` is the
/// error with the step `step_s`. Assumes that the error is proportional to the power `order` of the step.
double step_for(double relative, double limit, int order, double step_s);

}  // namespace mebots::master
