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

/// Differential equations x' = f(t, x) with event functions. An event occurs when an event function changes sign. The
/// integrator passes on exceptions of these functions.
class Equations {
 public:
  virtual ~Equations() = default;
  virtual std::size_t state_count() const = 0;
  virtual std::size_t root_count() const = 0;
  virtual Evaluation derivatives(double time_s, std::span<const double> states, std::span<double> derivatives) = 0;
  virtual Evaluation roots(double time_s, std::span<const double> states, std::span<double> values) = 0;
  virtual bool has_jacobian() const { return false; }
  /// Computes the Jacobian matrix. Requires has_jacobian(). `jacobian` must be zero before the call.
  virtual Evaluation jacobian(double /*time_s*/, std::span<const double> /*states*/, const Columns& /*jacobian*/) {
    return Evaluation::recoverable;
  }
  /// Returns the reason for the last recoverable failure, or an empty text.
  virtual std::string failure() const { return {}; }
  /// Returns a name of the equations for messages.
  virtual std::string subject() const = 0;
};

/// Integrates Equations with CVODE, one step at a time. Uses Newton's method and a dense matrix. Results depend only on
/// the equations and the arguments of restart().
class Integrator {
 public:
  enum class Reached { step, root, stop_time };

  /// Counts since the last restart.
  struct Counts {
    std::int64_t rejected_steps = 0;
    std::int64_t evaluations = 0;
    std::int64_t jacobians = 0;
  };

  struct Start {
    double time_s = 0;
    std::span<const double> states;
    std::span<const double> absolute_tolerances;
    double relative_tolerance = 0;
    double scale_s = 0;  ///< time scale of the problem [s]; the first step is much shorter
    double max_step_s = 0;
    std::optional<double> stop_time_s;  ///< no step extends past this time [s]; must be later than time_s
  };

  /// `equations` must outlive the integrator. Throws Error if memory is exhausted.
  Integrator(Equations& equations, SolverMethod method);
  ~Integrator();
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Restarts the integration at order 1.
  void restart(const Start& start);
  /// Performs one step. If an event function changes sign, the step ends there, and the function returns Reached::root.
  /// Throws Error (not_converged) if a step of minimum length fails.
  Reached advance();
  /// Returns the end of the last step [s].
  double time_s() const;
  std::span<const double> states() const;
  /// Computes the states at a time within the last step.
  void interpolate(double time_s, std::span<double> states) const;
  /// True if this event function changed sign. Valid after advance() returned Reached::root.
  bool is_root(std::size_t function) const;
  Counts counts() const;

 private:
  class Cvode;
  std::unique_ptr<Cvode> cvode_;
};

}  // namespace mebots::master
