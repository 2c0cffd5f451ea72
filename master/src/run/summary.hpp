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

/// The values at the last communication point that the config requests under `summary`.
class SummaryValues final : public Observer {
 public:
  /// Looks up the variables. Throws InputError for an unknown variable, or for a label that summary.json itself uses.
  SummaryValues(const ResolvedSystem& system, Ensemble& ensemble);

  std::optional<std::string> reached(const Point& point) override;

  /// Returns labels with values (numbers, Booleans, texts, item names of enumerations); empty before t = 0. Leaves out
  /// entries whose conditions were false. A group contains its members' values under `each`, and their statistics:
  ///
  /// - numbers: `least`, `mean`, `most`, and the names of the extremes under `least_of` and `most_of`;
  /// - Booleans: `count` of those that are true, and `of`, the number of all;
  /// - texts and items: `counts` of each.
  nlohmann::ordered_json values() const;
  /// Returns the same labels with units; leaves out values without a unit.
  nlohmann::ordered_json units() const;

 private:
  struct Entry {
    std::vector<std::string> path;
    const modeldesc::ModelDescription* model;
    const modeldesc::Variable* variable;
    SignalId signal;
    std::vector<Condition> when;
    bool shown = true;
    double number = 0;       // of a Real
    std::int64_t whole = 0;  // of an Integer or Boolean
    std::string text;
  };

  /// A group of the summary. Its members are the entries [first, first + count); its label is `path`.
  struct Group {
    std::vector<std::string> path;
    std::size_t first;
    std::size_t count;
  };

  void add_entry(const ResolvedSystem& system, Ensemble& ensemble, const SummaryEntry& entry);
  void add_group(const ResolvedSystem& system, Ensemble& ensemble, const SummaryEntry& entry);
  nlohmann::ordered_json value_of(const Entry& entry) const;
  /// Returns the statistics of a group by their labels.
  nlohmann::ordered_json statistics_of(const Group& group) const;

  const Ensemble* ensemble_;
  std::vector<Entry> entries_;
  std::vector<Group> groups_;  // by `first`
  bool any_point_ = false;
};

/// Wall time of a run's phases [s].
struct WallTimes {
  double open_s = 0;  ///< read the config, unpack and load the FMUs, check
  double initialise_s = 0;
  double stepping_s = 0;

  /// Returns the time of the phases in which instances are called.
  double simulating_s() const { return initialise_s + stepping_s; }
};

/// The result of a run.
struct RunReport {
  std::string outcome;                  ///< one of the config's outcomes, or "completed", "interrupted", "closed",
                                        ///< "failed"
  std::optional<EndReason> end_reason;  ///< empty before the end
  std::string end_text;
  std::string error;  ///< empty unless the run failed
  ErrorCode error_code = ErrorCode::unspecified;
  std::int64_t simulated_ns = 0;
  std::int64_t steps = 0;
  std::int64_t rows = 0;
  WallTimes wall;
  std::vector<std::string> overrides;  ///< changes to the config; the same text for every interface
  std::vector<std::string> notices;
  std::vector<std::string> writes;  ///< variables that a program set during the run, the first of them
  std::int64_t further_writes = 0;  ///< those that `writes` does not list
  std::vector<std::string> faults;  ///< of FMUs after the end, when they are terminated and freed

  /// Returns the simulated time divided by the wall time of stepping; 0 if there were no steps.
  double real_time_factor() const;
};

/// Returns the content of summary.json. All values except `real_time_factor` and `wall_clock` are equal for equal
/// inputs.
nlohmann::ordered_json summary_json(const ResolvedSystem& system, const InputHash& hash, const RunReport& report,
                                    const SummaryValues& values);

}  // namespace mebots::master
