// SPDX-License-Identifier: Apache-2.0
#include "solver/integrator.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <vector>

namespace mebots::master {
namespace {

/// A stop time that no run reaches. CVODE cannot remove a stop time.
constexpr double kNever = 1e300;

std::span<double> values_of(N_Vector vector) {
  return {N_VGetArrayPointer(vector), static_cast<std::size_t>(N_VGetLength(vector))};
}

}  // namespace

class Integrator::Cvode {
 public:
  Cvode(Equations& equations, SolverMethod method) : equations_(&equations), method_(method) {
    check(SUNContext_Create(nullptr, &context_), "SUNContext_Create");
    // CVODE requires a state. A system without states receives a state that is always 0.
    const auto count = static_cast<sunindextype>(std::max<std::size_t>(1, equations.state_count()));
    y_ = N_VNew_Serial(count, context_);
    tolerances_ = N_VNew_Serial(count, context_);
    matrix_ = SUNDenseMatrix(count, count, context_);
    if (y_ == nullptr || tolerances_ == nullptr || matrix_ == nullptr) throw_no_memory();
    solver_ = SUNLinSol_Dense(y_, matrix_, context_);
    roots_.resize(equations.root_count());
  }
  ~Cvode() {
    if (memory_ != nullptr) CVodeFree(&memory_);
    if (solver_ != nullptr) SUNLinSolFree(solver_);
    if (matrix_ != nullptr) SUNMatDestroy(matrix_);
    if (tolerances_ != nullptr) N_VDestroy(tolerances_);
    if (y_ != nullptr) N_VDestroy(y_);
    if (context_ != nullptr) SUNContext_Free(&context_);
  }
  Cvode(const Cvode&) = delete;
  Cvode& operator=(const Cvode&) = delete;

  void restart(const Start& start) {
    const auto y = values_of(y_);
    std::ranges::fill(y, 0);
    std::ranges::copy(start.states, y.begin());
    const auto tolerances = values_of(tolerances_);
    std::ranges::fill(tolerances, 1);
    std::ranges::copy(start.absolute_tolerances, tolerances.begin());
    if (memory_ == nullptr) {
      create(start.time_s);
    } else {
      check(CVodeReInit(memory_, start.time_s, y_), "CVodeReInit");
    }
    check(CVodeSVtolerances(memory_, start.relative_tolerance, tolerances_), "CVodeSVtolerances");
    check(CVodeSetMaxStep(memory_, start.max_step_s), "CVodeSetMaxStep");
    check(CVodeSetStopTime(memory_, start.stop_time_s.value_or(kNever)), "CVodeSetStopTime");
    MEBOTS_ASSERT(start.scale_s > 0 && start.max_step_s > 0);
    time_s_ = start.time_s;
    scale_s_ = start.scale_s;
  }

  Reached advance() {
    // CVODE fails instead of taking a smaller step. Smaller steps would not change the time, so the integration would
    // not end.
    const double shortest_s = 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(time_s_), scale_s_);
    check(CVodeSetMinStep(memory_, shortest_s), "CVodeSetMinStep");
    // In the mode CV_ONE_STEP, CVODE uses this time only for the size of the first step.
    const int flag = CVode(memory_, time_s_ + scale_s_, y_, &time_s_, CV_ONE_STEP);
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    if (flag == CV_ROOT_RETURN) {
      check(CVodeGetRootInfo(memory_, roots_.data()), "CVodeGetRootInfo");
      return Reached::root;
    }
    if (flag == CV_TSTOP_RETURN) return Reached::stop_time;
    if (flag < 0) fail(flag);
    return Reached::step;
  }

  double time_s() const { return time_s_; }
  std::span<const double> states() const { return values_of(y_).first(equations_->state_count()); }
  bool is_root(std::size_t function) const { return roots_[function] != 0; }

  void interpolate(double time_s, std::span<double> states) const {
    const auto at = N_VClone(y_);
    if (at == nullptr) throw_no_memory();
    const int flag = CVodeGetDky(memory_, time_s, 0, at);
    std::ranges::copy(values_of(at).first(states.size()), states.begin());
    N_VDestroy(at);
    check(flag, "CVodeGetDky");
  }

  Counts counts() const {
    if (memory_ == nullptr) return {};
    long evaluations = 0;
    long jacobian_evaluations = 0;
    long jacobians = 0;
    long failed_tests = 0;
    long failed_solutions = 0;
    check(CVodeGetNumRhsEvals(memory_, &evaluations), "CVodeGetNumRhsEvals");
    check(CVodeGetNumLinRhsEvals(memory_, &jacobian_evaluations), "CVodeGetNumLinRhsEvals");
    check(CVodeGetNumJacEvals(memory_, &jacobians), "CVodeGetNumJacEvals");
    check(CVodeGetNumErrTestFails(memory_, &failed_tests), "CVodeGetNumErrTestFails");
    check(CVodeGetNumStepSolveFails(memory_, &failed_solutions), "CVodeGetNumStepSolveFails");
    return {.rejected_steps = failed_tests + failed_solutions,
            .evaluations = evaluations + jacobian_evaluations,
            .jacobians = jacobians};
  }

 private:
  void create(double time_s) {
    memory_ = CVodeCreate(method_ == SolverMethod::bdf ? CV_BDF : CV_ADAMS, context_);
    if (memory_ == nullptr || solver_ == nullptr) throw_no_memory();
    check(CVodeSetErrHandlerFn(memory_, &Cvode::on_error, this), "CVodeSetErrHandlerFn");
    check(CVodeInit(memory_, &Cvode::right_hand_side, time_s, y_), "CVodeInit");
    check(CVodeSetUserData(memory_, this), "CVodeSetUserData");
    check(CVodeSetLinearSolver(memory_, solver_, matrix_), "CVodeSetLinearSolver");
    if (equations_->has_jacobian()) check(CVodeSetJacFn(memory_, &Cvode::jacobian), "CVodeSetJacFn");
    if (roots_.empty()) return;
    check(CVodeRootInit(memory_, static_cast<int>(roots_.size()), &Cvode::root_functions), "CVodeRootInit");
    check(CVodeSetNoInactiveRootWarn(memory_), "CVodeSetNoInactiveRootWarn");
  }

  /// Runs a callback and stores its exceptions, which must not pass through CVODE's C code.
  template <typename Work>
  int answer(Work work) noexcept {
    try {
      return work() == Evaluation::ok ? 0 : 1;
    } catch (...) {
      error_ = std::current_exception();
      return -1;
    }
  }

  std::span<const double> states_of(N_Vector y) const { return values_of(y).first(equations_->state_count()); }

  static int right_hand_side(double time_s, N_Vector y, N_Vector derivatives, void* self) {
    auto& cvode = *static_cast<Cvode*>(self);
    const auto all = values_of(derivatives);
    std::ranges::fill(all, 0);
    return cvode.answer([&] {
      return cvode.equations_->derivatives(time_s, cvode.states_of(y), all.first(cvode.equations_->state_count()));
    });
  }

  static int root_functions(double time_s, N_Vector y, double* values, void* self) {
    auto& cvode = *static_cast<Cvode*>(self);
    return cvode.answer([&] {
      return cvode.equations_->roots(time_s, cvode.states_of(y), {values, cvode.roots_.size()});
    });
  }

  static int jacobian(double time_s, N_Vector y, N_Vector /*derivatives*/, SUNMatrix matrix, void* self, N_Vector,
                      N_Vector, N_Vector) {
    auto& cvode = *static_cast<Cvode*>(self);
    if (cvode.equations_->state_count() == 0) return 0;  // CVODE has already set the matrix to zero
    return cvode.answer([&] {
      return cvode.equations_->jacobian(time_s, cvode.states_of(y),
                                        {SUNDenseMatrix_Data(matrix), cvode.equations_->state_count()});
    });
  }

  static void on_error(int /*code*/, const char* /*module*/, const char* function, char* message, void* self) {
    static_cast<Cvode*>(self)->message_ = fmt::format("{}: {}", function, message);
  }

  [[noreturn]] static void throw_no_memory() {
    throw Error(ErrorCode::system_failure, "there is no memory for the solver CVODE");
  }

  void check(int flag, const char* function) const {
    if (flag >= 0) return;
    throw Error(ErrorCode::system_failure,
                fmt::format("the solver CVODE failed: {} returned {} ({})", function, flag, message_));
  }

  [[noreturn]] void fail(int flag) const {
    const auto reason = equations_->failure();
    const auto code = reason.empty() ? ErrorCode::not_converged : ErrorCode::not_finite;
    throw Error(code, fmt::format("{}: the solver finds no step that is short enough after {} s: {}. Check inputs and "
                                  "parameters, or set other tolerances in \"solver\"",
                                  equations_->subject(), time_s_,
                                  reason.empty() ? fmt::format("CVODE returned {} ({})", flag, message_) : reason));
  }

  Equations* equations_;
  SolverMethod method_;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  N_Vector tolerances_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* memory_ = nullptr;
  std::vector<int> roots_;
  double time_s_ = 0;
  double scale_s_ = 1;
  std::string message_;
  std::exception_ptr error_;
};

Integrator::Integrator(Equations& equations, SolverMethod method)
    : cvode_(std::make_unique<Cvode>(equations, method)) {}
Integrator::~Integrator() = default;

void Integrator::restart(const Start& start) {
  cvode_->restart(start);
}

Integrator::Reached Integrator::advance() {
  return cvode_->advance();
}

double Integrator::time_s() const {
  return cvode_->time_s();
}

std::span<const double> Integrator::states() const {
  return cvode_->states();
}

void Integrator::interpolate(double time_s, std::span<double> states) const {
  cvode_->interpolate(time_s, states);
}

bool Integrator::is_root(std::size_t function) const {
  return cvode_->is_root(function);
}

Integrator::Counts Integrator::counts() const {
  return cvode_->counts();
}

}  // namespace mebots::master
