// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/conditions.hpp"
#include "record/observer.hpp"
#include "run/input_hash.hpp"

#include "mebots/error_code.hpp"
#include "mebots/run_state.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// Stores the values that the config requests under `summary`, as they are at the last communication point.
class SummaryValues final : public Observer {
 public:
  /// Throws InputError if a variable is unknown, or if a label is a key that summary.json uses itself.
  SummaryValues(const ResolvedSystem& system, Ensemble& ensemble);

  std::optional<std::string> reached(const Point& point) override;

  /// Returns the labels and their values (numbers, Booleans, texts, names of enumeration items). Empty before the
  /// start. Omits entries whose conditions are false. The value of a group contains the members' values under `each`,
  /// and statistics:
  ///
  /// - numbers: `least`, `mean` and `most`; `least_of` and `most_of` name the members with the extreme values;
  /// - Booleans: `count` is the number of true values, and `of` the number of all values;
  /// - texts and items: `counts` contains the number of occurrences of each value.
  nlohmann::ordered_json values() const;
  /// Returns the labels and the units of their values. Omits values without a unit.
  nlohmann::ordered_json units() const;

 private:
  struct Entry {
    std::vector<std::string> path;
    const modeldesc::ModelDescription* model;
    const modeldesc::Variable* variable;
    SignalId signal;
    std::vector<Condition> when;
    bool shown = true;
    double number = 0;       // value of a Real
    std::int64_t whole = 0;  // value of an Integer or Boolean
    std::string text;
  };

  /// A group with the label `path` and the entries [first, first + count).
  struct Group {
    std::vector<std::string> path;
    std::size_t first;
    std::size_t count;
  };

  void add_entry(const ResolvedSystem& system, Ensemble& ensemble, const SummaryEntry& entry);
  void add_group(const ResolvedSystem& system, Ensemble& ensemble, const SummaryEntry& entry);
  nlohmann::ordered_json value_of(const Entry& entry) const;
  /// Returns the statistics of a group. The keys are names of statistics, such as `mean`.
  nlohmann::ordered_json statistics_of(const Group& group) const;

  const Ensemble* ensemble_;
  std::vector<Entry> entries_;
  std::vector<Group> groups_;  // sorted by `first`
  bool any_point_ = false;
};

/// Wall times of the phases of a run [s].
struct WallTimes {
  double open_s = 0;  ///< reading the config, opening and checking the FMUs
  double initialise_s = 0;
  double stepping_s = 0;

  /// Returns the wall time of initialisation and stepping.
  double simulating_s() const { return initialise_s + stepping_s; }
};

struct RunReport {
  std::string outcome;  ///< an outcome of the config, or "completed", "interrupted", "closed" or "failed"
  std::optional<EndReason> end_reason;  ///< nullopt before the end
  std::string end_text;
  std::string error;  ///< empty unless the run failed
  ErrorCode error_code = ErrorCode::unspecified;
  std::int64_t simulated_ns = 0;
  std::int64_t steps = 0;
  std::int64_t rows = 0;
  WallTimes wall;
  std::vector<std::string> overrides;  ///< changes to the config as texts
  std::vector<std::string> notices;
  std::vector<std::string> writes;  ///< variables that a program set during the run, up to a limit
  std::int64_t further_writes = 0;  ///< number of writes beyond this limit
  std::vector<std::string> faults;  ///< errors of FMUs after the end of the run

  /// Returns the simulated time divided by the wall time of stepping. Returns 0 without steps.
  double real_time_factor() const;
};

/// Returns the content of summary.json. Equal inputs give equal values, except for `real_time_factor` and `wall_clock`.
nlohmann::ordered_json summary_json(const ResolvedSystem& system, const InputHash& hash, const RunReport& report,
                                    const SummaryValues& values);

}  // namespace mebots::master
