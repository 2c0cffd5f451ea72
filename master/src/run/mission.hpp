// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/system_description.hpp"
#include "message/message.hpp"
#include "observer/conditions.hpp"
#include "run/simulation.hpp"
#include "system/resolved_system.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// One recorded variable of a run.
struct Series {
  std::string name;  ///< instance.variable
  std::string unit;  ///< empty = none
  std::vector<double> values;
};

/// A mission in memory, for programs that drive one: read a config, change it, step it, look at and set variables, keep
/// what the config records. Writes no files. Times in seconds; values in the unit of their variable.
/// Everything throws InputError for what the user can mend, Error for a run that went wrong.
class Mission {
 public:
  /// Reads and checks a config.
  explicit Mission(const std::filesystem::path& config);
  ~Mission();
  Mission(const Mission&) = delete;
  Mission& operator=(const Mission&) = delete;

  /// What FMUs say goes there (instance, severity, text); nowhere by default. Before start().
  void on_message(std::function<void(const Message&)> listener);
  /// A parameter or start value, in place of the config's. Before start().
  void set(std::string_view variable, WrittenValue value);
  /// The end of the run [s]. Before start().
  void set_stop_time(double stop_time_s);
  /// Records these variables (patterns with * and ?) instead of the config's choice. Before start().
  void record(const std::vector<std::string>& patterns);

  /// Opens the FMUs and goes to t = 0; the other calls do it when it was not done.
  void start();
  /// One communication step. False when the end was reached before.
  bool step();
  /// To the end.
  void run();
  /// Steps until `time_s`, or the end when that comes first. Throws InputError for a time that is no number.
  void run_until(double time_s);

  double time_s() const;
  double step_s() const;
  double stop_time_s() const;
  bool ended() const;
  /// The config's outcome at the point reached last; "completed" when none of its conditions hold.
  std::string outcome() const;
  /// One sentence on why the run ended; empty before.
  std::string end_text() const;

  /// The value now: Reals, Integers, enumerations, Booleans as 0 and 1.
  double value(std::string_view variable);
  std::string text(std::string_view variable);
  /// Sets an input that nothing is connected to (or a tunable parameter) from now on.
  void write(std::string_view variable, double value);

  /// What was recorded so far: times [s], one per point, and as many values in each series.
  std::span<const double> times() const;
  std::span<const Series> series() const;

  const SystemDescription& system() const { return description_; }

 private:
  struct Running;

  ResolvedVariable find(std::string_view variable) const;
  void require_not_started(const char* what) const;

  SystemDescription description_;
  std::function<void(const Message&)> listener_;
  std::unique_ptr<Running> running_;
};

}  // namespace mebots::master
