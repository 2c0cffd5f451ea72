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

/// Returns a random number in the open interval (0, 1). Computes it from the SHA-256 of the arguments, so that it is
/// the same on every machine.
double unit_draw(std::int64_t seed, std::string_view name, std::int64_t index);

/// Returns the parameters "instance.calibration.*" that the config does not set. A draw sets them to random values. A
/// value from -1 to 1 is a position within the interval that a data file states for a quantity.
std::vector<std::string> calibration_parameters(const ResolvedSystem& system);
/// Opens the FMUs of a config and returns their calibration parameters, like the function above. Throws InputError if
/// the config or an FMU is invalid.
std::vector<std::string> calibration_parameters(const std::filesystem::path& config);

/// Repeats a run with random values of its calibration parameters. Each repetition is a drawn run.
class DrawnFlights {
 public:
  /// The number of drawn runs. A further independent draw is between the smallest and the largest of 19 draws with
  /// probability 18/20.
  static constexpr int kFlights = 19;
  static constexpr double kLevel = 0.9;
  static constexpr std::int64_t kSeed = 0;

  /// Called before each drawn run with its number, starting at 1.
  using Progress = std::function<void(int flight)>;

  /// `run` must have ended. Throws InputError if no FMU has calibration parameters.
  explicit DrawnFlights(Run& run);
  /// Performs all drawn runs. A failed run counts as an outcome. Returns false if a signal or the interrupt flag of the
  /// original run stops them.
  bool fly(const Progress& progress);

  /// Returns the FMUs' warnings about calibration parameters without an interval in the data file.
  const std::set<std::string>& without_effect() const { return without_effect_; }

  /// Returns the part of summary.json about the drawn runs: parameters, outcomes, the interval of each number of the
  /// summary, and warnings.
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

/// True if the options or the config request drawn runs, and `run` was not interrupted. The options take precedence.
bool wants_draws(const Run& run);

/// If wants_draws(run), performs the drawn runs and adds the intervals to the summary of `run`, which must have ended.
/// Skips the drawn runs if a program wrote variables or called start_from(), because drawn runs start at the start time
/// and use only the settings of `run`.
void add_draws(Run& run);

}  // namespace mebots::master
