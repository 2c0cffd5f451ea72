// SPDX-License-Identifier: Apache-2.0
#include "integrator.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <arkode/arkode_erkstep.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace mebots::battery {
namespace {

// Elements of the vector that SUNDIALS integrates. The duration of a step is integrated in one or more pieces. The
// energies start at zero in each piece, so that error control is relative to the energies of this piece.
enum Index : int {
  kSoc,
  kPair1,
  kPair2,
  kOpenCircuit,
  kDelivered,
  kSource,
  kOhmic,
  kPolarisation,
  kConverters,
  kSelfDischarge,
  kSize
};

// Absolute tolerances of the solver [1, V, J].
constexpr double kSocTolerance = 1e-12;
constexpr double kVoltageTolerance = 1e-10;
constexpr double kEnergyTolerance = 1e-10;
// Limits of the solver's steps in one piece, and of the evaluations of the right-hand side in one call of advance().
// The second limit is checked after each piece, except for a piece with which advance() ends successfully.
constexpr long kMaxSteps = 1'000'000;
constexpr long kMaxEvaluations = 5 * kMaxSteps;
// If a piece cannot be integrated, the next attempt uses a piece of a tenth of its length. If that length is below
// kShortestPiece [s], the integration fails.
constexpr double kPieceFactor = 10;
constexpr double kShortestPiece = 1e-15;
// Hysteresis of the low-voltage detection. Must exceed the tolerance of event location.
constexpr double kDetectorHysteresis_v = 1e-3;

enum Root : int { kProtectionRoot, kNoPowerRoot, kEmptyRoot, kFullRoot, kRootCount };

}  // namespace

Ledger& Ledger::operator+=(const Ledger& other) {
  open_circuit_j += other.open_circuit_j;
  delivered_j += other.delivered_j;
  source_j += other.source_j;
  ohmic_j += other.ohmic_j;
  polarisation_j += other.polarisation_j;
  converters_j += other.converters_j;
  self_discharge_j += other.self_discharge_j;
  return *this;
}

double Ledger::imbalance_j() const {
  return open_circuit_j + source_j - delivered_j - ohmic_j - polarisation_j - converters_j - self_discharge_j;
}

class Integrator::Solver {
 public:
  Solver(const Cell& cell, const Options& options) : cell_(cell) {
    check(SUNContext_Create(nullptr, &context_), "SUNContext_Create");
    y_ = N_VNew_Serial(kSize, context_);
    N_Vector tolerances = N_VNew_Serial(kSize, context_);
    memory_ = ERKStepCreate(&Solver::right_hand_side, 0, y_, context_);
    if (y_ == nullptr || tolerances == nullptr || memory_ == nullptr) throw Error("SUNDIALS: out of memory");
    double* tolerance = N_VGetArrayPointer(tolerances);
    std::fill(tolerance, tolerance + kSize, kEnergyTolerance);
    tolerance[kSoc] = kSocTolerance;
    tolerance[kPair1] = tolerance[kPair2] = kVoltageTolerance;
    check(ERKStepSVtolerances(memory_, options.relative_tolerance, tolerances), "ERKStepSVtolerances");
    N_VDestroy(tolerances);
    check(ERKStepSetErrHandlerFn(memory_, &Solver::on_error, this), "ERKStepSetErrHandlerFn");
    check(ERKStepSetUserData(memory_, this), "ERKStepSetUserData");
    check(ERKStepSetTableNum(memory_, ARKODE_ZONNEVELD_5_3_4), "ERKStepSetTableNum");
    check(ERKStepSetMaxNumSteps(memory_, kMaxSteps), "ERKStepSetMaxNumSteps");
    check(ERKStepRootInit(memory_, kRootCount, &Solver::root_functions), "ERKStepRootInit");
    check(ERKStepSetNoInactiveRootWarn(memory_), "ERKStepSetNoInactiveRootWarn");
    fixed_step_s_ = options.fixed_step_s;
    if (fixed_step_s_ > 0) check(ERKStepSetFixedStep(memory_, fixed_step_s_), "ERKStepSetFixedStep");
  }

  ~Solver() {
    if (memory_ != nullptr) ERKStepFree(&memory_);
    if (y_ != nullptr) N_VDestroy(y_);
    if (context_ != nullptr) SUNContext_Free(&context_);
  }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  Result advance(CellState& state, Ledger& ledger, const Demand& demand, Protection protection, double duration_s) {
    protection_ = protection;
    conducts_ = protection != Protection::open || demand.charges();
    demand_ = conducts_ ? demand : Demand{};
    MEBOTS_ASSERT(duration_s > 0);
    MEBOTS_ASSERT(state.soc >= 0 && state.soc <= 1 + kSocTolerance);
    MEBOTS_ASSERT(demand_.source_w >= demand_.source_bus_w, "a converter gives no more than it takes");
    charged_ = state.soc > 0;
    charging_ = demand_.charges();
    leaks_ = charged_ || charges_faster_than_leak(state);
    if (const auto event = event_at_start(state); event != Event::none) return {0, event};

    CellState now = state;
    Ledger sum = ledger;
    const long evaluations_before = evaluations_;
    double passed_s = 0;
    double piece_s = duration_s;
    Event event = Event::none;
    for (;;) {
      double reached_s = 0;
      const bool last = piece_s >= duration_s - passed_s;
      const int flag = evolve(now, sum, piece_s, reached_s);
      const bool too_much = flag == ARK_TOO_MUCH_WORK || evaluations_ - evaluations_before > kMaxEvaluations;
      if (flag < 0) {
        piece_s /= kPieceFactor;
        if (too_much || piece_s < kShortestPiece) fail(flag, duration_s, passed_s);
        continue;
      }
      passed_s = std::min(passed_s + reached_s, duration_s);
      if (flag == ARK_ROOT_RETURN) event = settle(now);
      if (last || flag == ARK_ROOT_RETURN) break;
      if (too_much) fail(ARK_TOO_MUCH_WORK, duration_s, passed_s);
      piece_s = std::min(piece_s * kPieceFactor, duration_s - passed_s);
    }
    MEBOTS_ASSERT(passed_s >= 0);
    state = now;
    ledger = sum;
    return {passed_s, event};
  }

  long evaluations() const { return evaluations_; }

 private:
  /// Returns true if the charging current exceeds the self-discharge. Otherwise, an empty cell stays empty.
  bool charges_faster_than_leak(const CellState& state) const {
    if (!charging_) return false;
    const Circuit circuit = cell_.circuit_at(state.soc);
    const double source_v = circuit.open_circuit_v - state.pair1_v - state.pair2_v;
    return terminal_current_a(source_v, circuit.series_ohm, demand_.terminal_w()) < -cell_.self_discharge_current_a;
  }

  Event event_at_start(const CellState& state) const {
    if (!conducts_) return Event::none;
    if (!charged_ && !charging_) return Event::empty;
    if (charging_ && state.soc >= 1) return Event::full;
    const double margin = protection_margin(state.soc, state.pair1_v, state.pair2_v);
    switch (protection_) {
      case Protection::open:
        return margin <= 0 ? Event::release : Event::none;
      case Protection::low:
        if (power_margin_w(state.soc, state.pair1_v, state.pair2_v) < 0) return Event::no_power;
        return margin <= 0 ? Event::recovered : Event::none;
      case Protection::closed:
        break;
    }
    return margin < 0 ? Event::cut_off : Event::none;
  }

  /// Integrates a piece of the duration. Returns ARKODE's flag; if the flag is negative, `state` and `ledger` are
  /// unchanged.
  int evolve(CellState& state, Ledger& ledger, double piece_s, double& reached_s) {
    double* y = N_VGetArrayPointer(y_);
    std::fill(y, y + kSize, 0.0);
    y[kSoc] = state.soc;
    y[kPair1] = state.pair1_v;
    y[kPair2] = state.pair2_v;
    // Restarts the solver, so that the result does not depend on earlier calls. The solver first tries one step for the
    // whole piece.
    check(ERKStepReInit(memory_, &Solver::right_hand_side, 0, y_), "ERKStepReInit");
    if (fixed_step_s_ == 0) check(ERKStepSetInitStep(memory_, piece_s), "ERKStepSetInitStep");
    check(ERKStepSetStopTime(memory_, piece_s), "ERKStepSetStopTime");
    const int flag = ERKStepEvolve(memory_, piece_s, y_, &reached_s, ARK_NORMAL);
    if (flag < 0) return flag;
    if (!all_finite(y)) return ARK_ERR_FAILURE;
    MEBOTS_ASSERT(reached_s >= 0 && reached_s <= piece_s);
    state = {y[kSoc], y[kPair1], y[kPair2]};
    ledger += Ledger{y[kOpenCircuit],  y[kDelivered],  y[kSource],       y[kOhmic],
                     y[kPolarisation], y[kConverters], y[kSelfDischarge]};
    return flag;
  }

  static bool all_finite(const double* y) {
    return std::all_of(y, y + kSize, [](double value) { return std::isfinite(value); });
  }

  /// Returns the event that root finding has located. If the cell is empty or full, sets the state of charge exactly to
  /// 0 or 1.
  Event settle(CellState& state) {
    int found[kRootCount] = {};
    check(ERKStepGetRootInfo(memory_, found), "ERKStepGetRootInfo");
    if (found[kEmptyRoot] != 0) {
      state.soc = 0;
      return Event::empty;
    }
    if (found[kFullRoot] != 0) {
      state.soc = 1;
      return Event::full;
    }
    if (found[kNoPowerRoot] != 0) return Event::no_power;
    switch (protection_) {
      case Protection::open:
        return Event::release;
      case Protection::low:
        return Event::recovered;
      case Protection::closed:
        break;
    }
    return Event::cut_off;
  }

  double series_ohm(double soc) const { return cell_.series_ohm(std::max(soc, cell_.hold_below_soc)); }

  /// Returns the greatest possible power minus the demanded power [W]. If the result is negative, no current gives the
  /// demanded power.
  double power_margin_w(double soc, double pair1_v, double pair2_v) const {
    return power_limit_w(cell_.open_circuit_v(soc) - pair1_v - pair2_v, series_ohm(soc), 0) - demand_.terminal_w();
  }

  /// Returns a value that falls through 0 when the state of the protection must change:
  ///
  ///   - closed [W]: power that can be added until the terminal voltage falls to the cut-off
  ///   - low [W]: power that must be removed until the terminal voltage is above the cut-off
  ///   - open [V]: voltage missing to the release voltage
  double protection_margin(double soc, double pair1_v, double pair2_v) const {
    const double source_v = cell_.open_circuit_v(soc) - pair1_v - pair2_v;
    const double ohm = series_ohm(soc);
    switch (protection_) {
      case Protection::closed:
        return power_limit_w(source_v, ohm, cell_.cut_off_voltage_v) - demand_.terminal_w();
      case Protection::low:
        return demand_.terminal_w() - power_limit_w(source_v, ohm, cell_.cut_off_voltage_v + kDetectorHysteresis_v);
      case Protection::open:
        break;
    }
    return cell_.release_voltage_v - (source_v - ohm * terminal_current_a(source_v, ohm, demand_.terminal_w()));
  }

  static int right_hand_side(double /*t*/, N_Vector y_vector, N_Vector derivative_vector, void* self) {
    auto& solver = *static_cast<Solver*>(self);
    ++solver.evaluations_;
    const double* y = N_VGetArrayPointer(y_vector);
    double* dy = N_VGetArrayPointer(derivative_vector);
    const Cell& cell = solver.cell_;
    const Demand& demand = solver.demand_;

    // If a step is too long, s may be far outside of 0 to 1, and values may be NaN. The error test then rejects the
    // step.
    const Circuit circuit = cell.circuit_at(y[kSoc]);
    const double source_v = circuit.open_circuit_v - y[kPair1] - y[kPair2];
    const double current_a =
        solver.conducts_ ? terminal_current_a(source_v, circuit.series_ohm, demand.terminal_w()) : 0;
    const double leak_a = solver.leaks_ ? cell.self_discharge_current_a : 0;
    const double resistor1_a = y[kPair1] / circuit.pair1_ohm;
    const double resistor2_a = y[kPair2] / circuit.pair2_ohm;
    const double capacitor1_a = current_a - resistor1_a;
    const double capacitor2_a = current_a - resistor2_a;

    dy[kSoc] = -(current_a + leak_a) / cell.capacity_c;
    dy[kPair1] = capacitor1_a / circuit.pair1_farad;
    dy[kPair2] = capacitor2_a / circuit.pair2_farad;
    dy[kOpenCircuit] = circuit.open_circuit_v * (current_a + leak_a);
    dy[kDelivered] = demand.delivered_w;
    dy[kSource] = demand.source_w;
    dy[kOhmic] = circuit.series_ohm * current_a * current_a + y[kPair1] * resistor1_a + y[kPair2] * resistor2_a;
    dy[kPolarisation] = y[kPair1] * capacitor1_a + y[kPair2] * capacitor2_a;
    dy[kConverters] = demand.converter_loss_w();
    dy[kSelfDischarge] = circuit.open_circuit_v * leak_a;
    return 0;
  }

  static int root_functions(double /*t*/, N_Vector y_vector, double* g, void* self) {
    const auto& solver = *static_cast<const Solver*>(self);
    const double* y = N_VGetArrayPointer(y_vector);
    // A constant disables a root function, because a constant never crosses zero.
    g[kProtectionRoot] = solver.conducts_ ? solver.protection_margin(y[kSoc], y[kPair1], y[kPair2]) : 1;
    const bool is_low = solver.protection_ == Protection::low;
    g[kNoPowerRoot] = is_low ? solver.power_margin_w(y[kSoc], y[kPair1], y[kPair2]) : 1;
    g[kEmptyRoot] = solver.charged_ ? y[kSoc] : 1;
    g[kFullRoot] = solver.charging_ ? 1 - y[kSoc] : 1;
    return 0;
  }

  static void on_error(int /*code*/, const char* /*module*/, const char* function, char* message, void* self) {
    static_cast<Solver*>(self)->message_ = fmt::format("{}: {}", function, message);
  }

  void check(int flag, const char* function) const {
    if (flag >= 0) return;
    throw Error(
        fmt::format("the cell's equations cannot be integrated: {} returned {} ({})", function, flag, message_));
  }

  [[noreturn]] void fail(int flag, double duration_s, double passed_s) const {
    throw Error(fmt::format(
        "the cell's equations cannot be integrated over a step of {} s at {} W terminal power: after {} s "
        "ERKStepEvolve returned {} ({}). Use shorter steps, less power, or a cell with a larger capacity and "
        "longer time constants",
        duration_s, demand_.terminal_w(), passed_s, flag, message_));
  }

  const Cell& cell_;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  void* memory_ = nullptr;
  double fixed_step_s_ = 0;
  long evaluations_ = 0;
  std::string message_;

  // Arguments of the present call of advance(), and conditions that are constant during this call.
  Demand demand_;
  Protection protection_ = Protection::closed;
  bool conducts_ = true;
  bool charged_ = true;
  bool leaks_ = true;
  bool charging_ = false;
};

Integrator::Integrator(const Cell& cell, const Options& options) : solver_(std::make_unique<Solver>(cell, options)) {}
Integrator::~Integrator() = default;

Integrator::Result Integrator::advance(CellState& state, Ledger& ledger, const Demand& demand, Protection protection,
                                       double duration_s) {
  return solver_->advance(state, ledger, demand, protection, duration_s);
}

long Integrator::evaluations() const {
  return solver_->evaluations();
}

}  // namespace mebots::battery
