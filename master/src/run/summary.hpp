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

/// Final values that the config asks for under `summary`, as they stood at the last point reached.
class SummaryValues final : public Observer {
 public:
  /// Throws InputError for an unknown variable or a label that summary.json uses itself.
  SummaryValues(const ResolvedSystem& system, Ensemble& ensemble);

  std::optional<std::string> reached(const Point& point) override;

  /// Labels to values (numbers, true and false, texts, enumerations as their item's name); empty before t = 0. What was
  /// not measured, by the conditions of its entry, is left out.
  nlohmann::ordered_json values() const;
  /// The same labels to units, without those that have none.
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

  nlohmann::ordered_json value_of(const Entry& entry) const;

  const Ensemble* ensemble_;
  std::vector<Entry> entries_;
  bool any_point_ = false;
};

/// How long the phases of a run took by the wall clock [s].
struct WallTimes {
  double open_s = 0;  ///< read the config, unpack and load the FMUs, check
  double initialise_s = 0;
  double stepping_s = 0;

  /// In which instances are called.
  double simulating_s() const { return initialise_s + stepping_s; }
};

/// The result of a run.
struct RunReport {
  std::string outcome;                  ///< of the config's outcomes, or "completed"; "interrupted", "closed", "failed"
  std::optional<EndReason> end_reason;  ///< nothing before the end
  std::string end_text;
  std::string error;  ///< empty unless failed
  ErrorCode error_code = ErrorCode::unspecified;
  std::int64_t simulated_ns = 0;
  std::int64_t steps = 0;
  std::int64_t rows = 0;
  WallTimes wall;
  std::vector<std::string> overrides;  ///< what was asked for beyond the config, the same text from every door
  std::vector<std::string> notices;
  std::vector<std::string> writes;  ///< variables that a program set on the way
  std::vector<std::string> faults;  ///< of FMUs after the end, when they are terminated and freed

  /// Simulated time over stepping time; 0 when nothing was stepped.
  double real_time_factor() const;
};

/// The content of summary.json. All but `real_time_factor` and `wall_clock` is the same for the same inputs.
nlohmann::ordered_json summary_json(const ResolvedSystem& system, const InputHash& hash, const RunReport& report,
                                    const SummaryValues& values);

}  // namespace mebots::master
