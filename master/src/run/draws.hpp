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

/// Returns a draw from the open interval (0, 1): 53 bits of the SHA-256 of the arguments. A draw is the same on every
/// machine and independent of other draws.
double unit_draw(std::int64_t seed, std::string_view name, std::int64_t index);

/// Returns the parameters that a draw sets, as "instance.variable". Their names are calibration.*; each value is a
/// position from -1 to 1 in the interval that a data file gives for a quantity. Leaves out parameters that the system
/// sets.
std::vector<std::string> calibration_parameters(const ResolvedSystem& system);
/// Opens the FMUs of a config and returns these parameters. Throws InputError.
std::vector<std::string> calibration_parameters(const std::filesystem::path& config);

/// Runs of the same system with drawn parameters.
class DrawnFlights {
 public:
  /// The rank of a further draw among 20 draws is uniform, for any distribution. So it lies between the least and the
  /// greatest of the first 19 with a probability of 18/20.
  static constexpr int kFlights = 19;
  static constexpr double kLevel = 0.9;
  static constexpr std::int64_t kSeed = 0;

  /// Called before each run with the number of the run, from 1 on.
  using Progress = std::function<void(int flight)>;

  /// Prepares the runs. `run` must have ended. Throws InputError if no FMU has calibration parameters.
  explicit DrawnFlights(Run& run);
  /// Performs all runs. A failed run counts as an outcome. Returns false if a signal, or the interrupt flag of the
  /// original run, interrupted it.
  bool fly(const Progress& progress);

  /// Returns the FMUs' warnings about calibration parameters whose data file has no interval.
  const std::set<std::string>& without_effect() const { return without_effect_; }

  /// Returns the parameters, outcomes, interval of each number in the summary, and warnings, for summary.json.
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

/// True if the options or the config request drawn runs and `run` has ended without an interrupt.
bool wants_draws(const Run& run);

/// If `run` has ended and uncertainty is requested, performs further runs with drawn parameters, and adds their
/// intervals to the summary of `run`. These runs start at t = 0 and use only the settings. Therefore none are performed
/// if a program wrote variables or used start_from().
void add_draws(Run& run);

}  // namespace mebots::master
