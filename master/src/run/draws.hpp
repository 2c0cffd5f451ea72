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

/// Returns a random number in the open interval (0, 1), computed from 53 bits of the SHA-256 of the arguments. The
/// number is the same on every machine and does not depend on other calls.
double unit_draw(std::int64_t seed, std::string_view name, std::int64_t index);

/// Returns the names, "instance.variable", of the parameters that a draw sets: those named `calibration.*`. Each of
/// them is a position from -1 to 1 within the interval that a data file states for a quantity. Leaves out parameters
/// that the config sets.
std::vector<std::string> calibration_parameters(const ResolvedSystem& system);
/// Opens the FMUs of a config and returns the parameters that a draw sets. Throws InputError if the config or an FMU is
/// invalid.
std::vector<std::string> calibration_parameters(const std::filesystem::path& config);

/// Repeats a run several times with random values of its calibration parameters. These repetitions are called drawn
/// runs.
class DrawnFlights {
 public:
  /// The number of drawn runs. Among 20 independent draws, each is equally likely to be the smallest or the largest.
  /// Therefore the 20th draw is between the smallest and the largest of the other 19 with a probability of 18/20.
  static constexpr int kFlights = 19;
  static constexpr double kLevel = 0.9;
  static constexpr std::int64_t kSeed = 0;

  /// A function that is called before each drawn run with its number, starting at 1.
  using Progress = std::function<void(int flight)>;

  /// Prepares the repetition of `run`, which must have ended. Throws InputError if no FMU has calibration parameters.
  explicit DrawnFlights(Run& run);
  /// Performs all drawn runs. A failed run counts as an outcome. Returns false if a signal, or the interrupt flag of
  /// the original run, has ended them early.
  bool fly(const Progress& progress);

  /// Returns the FMUs' warnings about calibration parameters for which the data file contains no interval.
  const std::set<std::string>& without_effect() const { return without_effect_; }

  /// Returns the result for summary.json: the parameters, the outcomes, the interval of each number in the summary, and
  /// warnings.
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

/// True if the options (otherwise the config) request drawn runs, and `run` was not interrupted.
bool wants_draws(const Run& run);

/// If wants_draws() is true, performs the drawn runs and adds the intervals of the results to the summary of `run`,
/// which must have ended. Drawn runs start at t = 0 and use only the settings of `run`. Therefore none are performed if
/// a program wrote variables or called start_from().
void add_draws(Run& run);

}  // namespace mebots::master
