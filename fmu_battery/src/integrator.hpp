// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cell.hpp"
#include "mebots/state/visitor.hpp"

#include <memory>

namespace mebots::battery {

/// The differential states of a cell.
struct CellState {
  double soc = 1;      // state of charge
  double pair1_v = 0;  // voltages of the RC pairs, positive after discharge
  double pair2_v = 0;

  void visit(state::Visitor& v) {
    v("soc", soc);
    v("pair1_v", pair1_v);
    v("pair2_v", pair2_v);
  }
};

/// Energies in joules.
/// open_circuit + source = delivered + ohmic + polarisation + converters + self_discharge.
struct Ledger {
  double open_circuit_j = 0;  // given by the open-circuit source, charging counts negative
  double delivered_j = 0;
  double source_j = 0;
  double ohmic_j = 0;         // heat in R0, R1, R2
  double polarisation_j = 0;  // into C1, C2
  double converters_j = 0;
  double self_discharge_j = 0;

  Ledger& operator+=(const Ledger& other);
  double imbalance_j() const;

  void visit(state::Visitor& v) {
    v("open_circuit_j", open_circuit_j);
    v("delivered_j", delivered_j);
    v("source_j", source_j);
    v("ohmic_j", ohmic_j);
    v("polarisation_j", polarisation_j);
    v("converters_j", converters_j);
    v("self_discharge_j", self_discharge_j);
  }
};

/// What hangs on the cell's terminals, held during a step.
struct Demand {
  double delivered_w = 0;   // at the outputs of the loads' converters
  double drawn_w = 0;       // at their inputs
  double source_w = 0;      // at the input of the source's converter
  double source_bus_w = 0;  // at its output

  double terminal_w() const { return drawn_w - source_bus_w; }
  bool charges() const { return terminal_w() < 0; }
  double converter_loss_w() const { return drawn_w - delivered_w + source_w - source_bus_w; }
};

/// Why an advance ended before its time.
enum class Event {
  none,
  cut_off,    // the terminal voltage would fall under the cut-off, or no current gives that much power
  no_power,   // while low: no current gives that much power
  recovered,  // while low: the terminal voltage is above the cut-off again
  empty,      // state of charge 0
  full,       // state of charge 1 while charging
  release,    // a charger has lifted the terminals behind an open protection to the release voltage
};

/// The switch between cell and bus.
enum class Protection {
  closed,
  low,   // still closed, with the terminal voltage under the cut-off: its delay passes
  open,  // blocks discharge; a charge passes, as through the body diode of the discharge transistor
};

/// Integrates the cell's ODEs and its ledger together with SUNDIALS (ARKODE's ERKStep, order 4), adaptive with local
/// error control, the events located by root finding. Knows no history: what it returns depends on its
/// arguments alone, so a restored run repeats the same bits. Not thread-safe; one per instance.
///
///   ds/dt  = -(i + i_sd) / Q
///   dvk/dt = (i - vk / Rk(s)) / Ck(s),   k = 1, 2
///   i R0(s)^2 - E i + P = 0 solved for the smaller i, E = OCV(s) - v1 - v2
class Integrator {
 public:
  struct Options {
    double relative_tolerance = 1e-9;
    double fixed_step_s = 0;  // > 0: no error control; for measuring the order of convergence
  };

  explicit Integrator(const Cell& cell) : Integrator(cell, Options{}) {}
  Integrator(const Cell& cell, const Options& options);
  ~Integrator();
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  struct Result {
    double reached_s = 0;  // time that went by, <= duration
    Event event = Event::none;
  };

  /// Moves `state` on by `duration_s`, or up to the first event, and adds to `ledger`.
  /// If the protection is closed or low, the cell feeds `demand`. If it is open, only a demand that charges the cell
  /// acts. A duration that the solver cannot integrate whole is divided. If the smallest part fails too, throws
  /// mebots::Error with duration, power and remedy, and leaves `state` and `ledger` unchanged.
  Result advance(CellState& state, Ledger& ledger, const Demand& demand, Protection protection, double duration_s);

  /// Evaluations of the right-hand side so far; a measure of cost.
  long evaluations() const;

 private:
  class Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace mebots::battery
