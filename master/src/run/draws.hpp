// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// A draw from the open interval (0, 1): 53 bits of a SHA-256 of the arguments, so that each draw is the same on every
/// machine, whatever else is drawn.
double unit_draw(std::int64_t seed, std::string_view name, std::int64_t index);

/// The parameters that a draw sets, as "instance.variable": those named calibration.*, of which each is a position from
/// -1 to 1 in the interval that a data file gives for a quantity. Without those that the system sets.
std::vector<std::string> calibration_parameters(const ResolvedSystem& system);
/// The same of a config, whose FMUs are opened for it. Throws InputError.
std::vector<std::string> calibration_parameters(const std::filesystem::path& config);

/// Flights of the same system with drawn parameters.
class DrawnFlights {
 public:
  /// A further draw of a quantity lies between the least and the greatest of 19 with a chance of 18/20: its rank among
  /// the 20 is uniform, whatever the distribution.
  static constexpr int kFlights = 19;
  static constexpr double kLevel = 0.9;
  static constexpr std::int64_t kSeed = 0;

  /// Called before each flight with its number from 1.
  using Progress = std::function<void(int flight)>;

  /// `run` has ended. Throws InputError if no FMU has calibration parameters.
  explicit DrawnFlights(Run& run);
  /// Flies all. A flight that fails counts as an outcome. Returns false if a signal, or the interrupt flag of the run
  /// that has ended, interrupted it.
  bool fly(const Progress& progress);

  /// Warnings of FMUs about calibration parameters whose data file has no interval.
  const std::set<std::string>& without_effect() const { return without_effect_; }

  /// For summary.json: parameters, outcomes, the interval of each number of the summary, and the warnings.
  nlohmann::ordered_json json() const;

 private:
  void fly_one(int flight);

  Run* run_;
  std::vector<std::string> parameters_;
  std::vector<nlohmann::ordered_json> summaries_;
  std::map<std::string, int> outcomes_;
  std::set<std::string> without_effect_;
  bool interrupted_ = false;
};

/// True if the options or the config of a run that has ended ask for drawn flights. An interrupted run has none.
bool wants_draws(const Run& run);

/// Flies the draws of a run that has ended, if it wants them, and adds them to its summary. Draws begin at t = 0 with
/// the settings alone. Therefore there are none if a program wrote variables or began the run in its middle.
void add_draws(Run& run);

}  // namespace mebots::master
