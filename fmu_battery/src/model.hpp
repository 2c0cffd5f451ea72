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

/// Models a power bus with its cell, protection, converters, loads and source.
///
/// Inputs are powers and are constant during a step; outputs are values at the end of the step.
///
/// The protection opens in three cases: the terminal voltage was below the cut-off for the cell's delay, no current
/// gives the requested power, or the state of charge is 0. An open protection blocks discharge: bus voltage, current
/// and delivered power are 0, also for the rest of the step. If the source gives more than the loads take, the source
/// supplies the loads and charges the cell. The protection closes when the terminal voltage reaches the release
/// voltage.
///
/// A full cell takes no charge until its state of charge is below kResumeChargingBelow. Until then, the source gives at
/// most what the loads take.
class Model {
 public:
  static constexpr double kResumeChargingBelow = 0.999;
  /// Time constant of the cell's heating. The log warns only if the mean square of the current over this time exceeds
  /// the square of the continuous limit. Heat capacity divided by heat transfer is 100 to 600 s for cells of 5 to 10 g,
  /// with 1000 J/(kg K), 16 cm^2 and 10 to 30 W/(m^2 K). The least value gives the earliest warning.
  static constexpr double kHeatingTimeConstant_s = 100;

  /// Kind of a message. An event is normal behaviour, such as an opening of the protection or a full cell. A warning
  /// needs an action of the user.
  enum class Message { event, warning };
  using Log = std::function<void(Message, std::string_view)>;

  /// Reads `resources`/cells/<name>.json and `resources`/converters.json. Throws mebots::Error that names parameter or
  /// file, key, value and limit.
  Model(const Parameters& parameters, const std::filesystem::path& resources, Log log);

  void start(const Inputs& inputs, std::int64_t start_ns, Outputs& outputs);

  /// Advances from start_ns to start_ns + duration_ns (> 0). Throws mebots::Error if a power is negative or not finite.
  void step(const Inputs& inputs, std::int64_t start_ns, std::int64_t duration_ns, Outputs& outputs);

  /// Logs the time with a current above the continuous limit, and the largest current. Without such a time, logs
  /// nothing.
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
  bool low_ = false;  // the terminal voltage is below the cut-off; low_s_ is the time since then
  double low_s_ = 0;
  bool full_ = false;
  double mean_square_a2_ = 0;  // mean over kHeatingTimeConstant_s
  bool overload_warned_ = false;
  std::int64_t over_current_ns_ = 0;  // time with the current above the continuous limit
  double highest_current_a_ = 0;
};

}  // namespace mebots::battery
