// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cell.hpp"
#include "mebots/state/visitor.hpp"

#include <memory>

namespace mebots::battery {

struct CellState {
  double soc = 1;      // state of charge
  double pair1_v = 0;  // voltages of the RC pairs, positive after a discharge
  double pair2_v = 0;

  void visit(state::Visitor& v) {
    v("soc", soc);
    v("pair1_v", pair1_v);
    v("pair2_v", pair2_v);
  }
};

/// Energies [J], whose balance is open_circuit + source = delivered + ohmic + polarisation + converters +
/// self_discharge.
struct Ledger {
  double open_circuit_j = 0;  // from the open-circuit source; negative while charging
  double delivered_j = 0;
  double source_j = 0;
  double ohmic_j = 0;         // heat in R0, R1, R2
  double polarisation_j = 0;  // stored in C1, C2
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

/// Powers of the loads and of the source on the bus, constant during a call of advance().
struct Demand {
  double delivered_w = 0;   // sum of the powers at the outputs of the loads' converters
  double drawn_w = 0;       // sum of the powers at the inputs of the loads' converters
  double source_w = 0;      // power at the input of the source's converter
  double source_bus_w = 0;  // power at the output of the source's converter

  double terminal_w() const { return drawn_w - source_bus_w; }
  bool charges() const { return terminal_w() < 0; }
  double converter_loss_w() const { return drawn_w - delivered_w + source_w - source_bus_w; }
};

/// Reason why advance() returned before the end of the duration.
enum class Event {
  none,
  cut_off,    // the terminal voltage would fall below the cut-off, or no current gives the power
  no_power,   // protection low: no current gives the demanded power
  recovered,  // protection low: the terminal voltage is above the cut-off again
  empty,      // the state of charge is 0
  full,       // the state of charge is 1 while charging
  release,    // protection open: a charger raised the terminal voltage to the release voltage
};

/// State of the switch between cell and bus.
enum class Protection {
  closed,
  low,   // closed; the terminal voltage is below the cut-off, and the delay has not passed
  open,  // blocks discharge, but not charge: the body diode of the discharge transistor conducts
};

/// Integrates the cell's differential equations and energies with SUNDIALS (ERKStep of ARKODE, order 4). The steps
/// are adaptive, and root finding locates the events. The integrator keeps no state between calls, so that a restored
/// run has the same bits. It is not thread-safe: use one integrator per instance.
///
///   ds/dt  = -(i + i_sd) / Q
///   dvk/dt = (i - vk / Rk(s)) / Ck(s),   k = 1, 2
///   i R0(s)^2 - E i + P = 0 solved for the smaller i, E = OCV(s) - v1 - v2
class Integrator {
 public:
  struct Options {
    double relative_tolerance = 1e-9;
    double fixed_step_s = 0;  // if > 0, size of all steps, without error control
  };

  explicit Integrator(const Cell& cell) : Integrator(cell, Options{}) {}
  Integrator(const Cell& cell, const Options& options);
  ~Integrator();
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  struct Result {
    double reached_s = 0;  // integrated part of the duration
    Event event = Event::none;
  };

  /// Advances `state` by `duration_s` or to the first event, and adds the energies to `ledger`. A closed or low
  /// protection lets the cell supply `demand`. An open protection only lets `demand` charge the cell. If the
  /// integration fails, throws mebots::Error with duration, power and a way out; `state` and `ledger` are then
  /// unchanged.
  Result advance(CellState& state, Ledger& ledger, const Demand& demand, Protection protection, double duration_s);

  /// Returns how many times the right-hand side of the cell's equations has been evaluated since construction.
  long evaluations() const;

 private:
  class Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace mebots::battery
