// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cell.hpp"
#include "converter.hpp"
#include "fmu_battery/variables.hpp"
#include "integrator.hpp"
#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace mebots::battery {

/// Models a power bus with its cell, protection, converters, loads and source in plain C++; fmu.cpp binds the class to
/// FMI.
///
/// Inputs are powers and are constant during a step; outputs are values at the end of the step.
///
/// The protection opens in three cases: the terminal voltage was below the cut-off for the cell's delay, no current
/// gives the requested power, or the state of charge is 0. An open protection blocks discharge: bus voltage, current
/// and delivered power are 0, also for the rest of the step. If the source gives more than the loads take, it supplies
/// them, and charges the cell through the open protection. The protection closes when the terminal voltage reaches the
/// release voltage.
///
/// A full cell takes no charge until its state of charge is below kResumeChargingBelow. Until then, the source only
/// supplies the loads, and the rest of its power is not used.
class Model {
 public:
  static constexpr double kResumeChargingBelow = 0.999;
  /// Time constant of the cell's heating. The continuous limit is thermal: the log warns only if the mean square of the
  /// current over this time exceeds the square of the limit. Heat capacity divided by heat transfer is 100 to 600 s for
  /// cells of 5 to 10 g, with 1000 J/(kg K), 16 cm^2 and 10 to 30 W/(m^2 K). The constant is the smallest of these
  /// values, which gives the earliest warning.
  static constexpr double kHeatingTimeConstant_s = 100;

  /// Classifies a message. An event is normal behaviour of the model: the protection opens or closes, the cell is full,
  /// or the current exceeded the limit for some time. A warning requires an action of the user.
  enum class Message { event, warning };
  /// Receives each message of the model, in the order of simulated time.
  using Log = std::function<void(Message, std::string_view)>;

  /// Reads `resources`/cells/<name>.json and `resources`/converters.json. Throws mebots::Error that names parameter or
  /// file, key, value and limit.
  Model(const Parameters& parameters, const std::filesystem::path& resources, Log log);

  /// Sets the outputs to their values at the start.
  void start(const Inputs& inputs, std::int64_t start_ns, Outputs& outputs);

  /// Advances from start_ns to start_ns + duration_ns (> 0). Throws mebots::Error if a power is negative or not finite.
  void step(const Inputs& inputs, std::int64_t start_ns, std::int64_t duration_ns, Outputs& outputs);

  /// Logs for how long the current was above the continuous limit, and the largest current. Logs nothing if the current
  /// never exceeded the limit.
  void terminate();

  void visit(state::Visitor& v);

  const Cell& cell() const { return cell_; }
  const CellState& cell_state() const { return state_; }
  const Ledger& ledger() const { return ledger_; }

 private:
  Demand demand(const Inputs& inputs) const;
  Protection protection() const;
  void handle(Event event, double time_s);
  void handle_low(double time_s);
  std::string cut_off_text() const;
  void open(std::string_view why, double time_s);
  void report(std::string_view text) { log_(Message::event, text); }
  bool over_current(double current_a) const;
  void watch_current(double current_a, std::int64_t now_ns, std::int64_t duration_ns);
  void write(const Inputs& inputs, Outputs& outputs) const;

  Log log_;
  Cell cell_;
  std::array<Converter, load::kCount> load_converter_;
  Converter source_converter_;
  Integrator integrator_;

  CellState state_;
  Ledger ledger_;
  std::array<double, load::kCount> load_energy_j_{};
  /// Returns true if current flows between cell and bus.
  bool conducts(const Demand& demand) const { return connected_ || demand.charges(); }

  bool connected_ = true;
  bool low_ = false;  // true while the terminal voltage is below the cut-off; low_s_ is the time since then
  double low_s_ = 0;
  bool full_ = false;
  double mean_square_a2_ = 0;  // mean square of the current over kHeatingTimeConstant_s
  bool overload_warned_ = false;
  std::int64_t over_current_ns_ = 0;  // time with the current above the continuous limit
  double highest_current_a_ = 0;
};

}  // namespace mebots::battery
