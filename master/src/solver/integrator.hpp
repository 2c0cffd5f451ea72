// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/solver_description.hpp"
#include "solver/continuous_instance.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace mebots::master {

/// A matrix in column-major order.
struct Columns {
  double* data = nullptr;
  std::size_t rows = 0;

  std::span<double> column(std::size_t j) const { return {data + j * rows, rows}; }
};

/// The differential equations x' = f(t, x), and event functions: a sign change of such a function is an event.
/// Exceptions pass through the integrator.
class Equations {
 public:
  virtual ~Equations() = default;
  virtual std::size_t state_count() const = 0;
  virtual std::size_t root_count() const = 0;
  virtual Evaluation derivatives(double time_s, std::span<const double> states, std::span<double> derivatives) = 0;
  virtual Evaluation roots(double time_s, std::span<const double> states, std::span<double> values) = 0;
  virtual bool has_jacobian() const { return false; }
  /// Computes the Jacobian matrix. Called only if has_jacobian() is true. All elements of `jacobian` are zero at the
  /// call.
  virtual Evaluation jacobian(double /*time_s*/, std::span<const double> /*states*/, const Columns& /*jacobian*/) {
    return Evaluation::recoverable;
  }
  /// Returns the reason of the last recoverable failure; empty if the reason is unknown.
  virtual std::string failure() const { return {}; }
  /// Returns a name of the equations, for messages.
  virtual std::string subject() const = 0;
};

/// Integrates Equations with CVODE, Newton's method and a dense matrix, one step at a time. The result depends only on
/// the equations and on the arguments of restart().
class Integrator {
 public:
  enum class Reached { step, root, stop_time };

  /// Numbers of the solver's operations since the last restart.
  struct Counts {
    std::int64_t rejected_steps = 0;
    std::int64_t evaluations = 0;
    std::int64_t jacobians = 0;
  };

  /// Arguments of a restart.
  struct Start {
    double time_s = 0;
    std::span<const double> states;
    std::span<const double> absolute_tolerances;
    double relative_tolerance = 0;
    double scale_s = 0;  ///< the first step is much shorter
    double max_step_s = 0;
    std::optional<double> stop_time_s;  ///< no step extends beyond it; must be later than time_s
  };

  /// `equations` must outlive the integrator. Throws Error if there is no memory.
  Integrator(Equations& equations, SolverMethod method);
  ~Integrator();
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Restarts the integration with a method of order 1.
  void restart(const Start& start);
  /// Takes one step. If an event function changes its sign, the step ends there (Reached::root). Throws Error
  /// (not_converged) if even a step of the minimum length fails.
  Reached advance();
  /// Returns the time at the end of the last step.
  double time_s() const;
  std::span<const double> states() const;
  /// Returns the states at a time within the last step.
  void interpolate(double time_s, std::span<double> states) const;
  /// After Reached::root, returns true if this event function has changed its sign.
  bool is_root(std::size_t function) const;
  Counts counts() const;

 private:
  class Cvode;
  std::unique_ptr<Cvode> cvode_;
};

}  // namespace mebots::master
