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

/// Cell, protection, converters, loads and source of one power bus. Plain C++; fmu.cpp binds it to FMI.
///
/// Inputs are powers and are constant during a step; outputs are values at the end of the step.
///
/// The protection opens in three cases: the terminal voltage was below the cut-off for the cell's delay, no current
/// gives the requested power, or the state of charge is 0. An open protection blocks discharge: bus voltage, current
/// and delivered power are 0, also for the rest of the step. If the source gives more than the loads take, it supplies
/// them, and charges the cell through the open protection. The protection closes when the terminal voltage reaches the
/// release voltage.
///
/// A full cell takes no charge until its state of charge is below kResumeChargingBelow. Until then, the source supplies
/// the loads only, and the rest of its power does not count.
class Model {
 public:
  static constexpr double kResumeChargingBelow = 0.999;
  /// The log reports a current above the continuous limit after this time without interruption; the output reports it
  /// at once. The limit is thermal, and a take-off of some tenths of a second does not heat the cell.
  static constexpr std::int64_t kWarnOverCurrentAfterNs = 1'000'000'000;

  /// Called for each event (protection, over-current, full cell), in the order of time.
  using EventLog = std::function<void(std::string_view)>;

  /// Reads `resources`/cells/<name>.json and `resources`/converters.json. Throws mebots::Error that names parameter or
  /// file, key, value and limit.
  Model(const Parameters& parameters, const std::filesystem::path& resources, EventLog log);

  /// Writes the outputs at the start.
  void start(const Inputs& inputs, std::int64_t start_ns, Outputs& outputs);

  /// Advances from start_ns to start_ns + duration_ns (> 0). Throws mebots::Error if a power is negative or not finite.
  void step(const Inputs& inputs, std::int64_t start_ns, std::int64_t duration_ns, Outputs& outputs);

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
  void watch_current(double current_a, std::int64_t now_ns);
  void write(const Inputs& inputs, std::int64_t now_ns, Outputs& outputs);

  EventLog log_;
  Cell cell_;
  std::array<Converter, load::kCount> load_converter_;
  Converter source_converter_;
  Integrator integrator_;

  CellState state_;
  Ledger ledger_;
  std::array<double, load::kCount> load_energy_j_{};
  /// True if current flows between cell and bus.
  bool conducts(const Demand& demand) const { return connected_ || demand.charges(); }

  bool connected_ = true;
  bool low_ = false;  // the terminal voltage is below the cut-off, since low_s_
  double low_s_ = 0;
  bool full_ = false;
  bool over_current_ = false;
  bool over_current_warned_ = false;
  std::int64_t over_current_since_ns_ = 0;  // start of the present over-current
};

}  // namespace mebots::battery
