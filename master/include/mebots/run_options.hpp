// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace mebots {

namespace state {
class Visitor;
}

/// The text of a value from `--set`. It is converted to the type of the variable when the FMU is opened.
struct UntypedText {
  std::string text;

  void visit(state::Visitor& v);
};

/// A value for a variable. An enumeration accepts the name or the number of an item.
using Value = std::variant<double, std::int64_t, bool, std::string, UntypedText>;

/// Replaces a start value of the config.
struct Setting {
  std::string variable;  ///< "instance.variable"; * and ? select several variables
  Value value;
  std::string place;  ///< origin of the setting for error messages, such as "--set a.b=3"

  void visit(state::Visitor& v);
};

/// A time in seconds: a number, or a ratio of whole numbers such as "1/60".
using WrittenTime = std::variant<double, std::string>;

/// Options of a run. By default, the run writes no files and keeps the recorded rows in memory.
struct RunOptions {
  std::filesystem::path out;                       ///< folder for results.csv, summary.json, log.txt; empty = no files
  bool in_memory = true;                           ///< keep the recorded rows in memory
  std::vector<Setting> settings;                   ///< if a variable is set twice, the last value applies
  std::vector<std::filesystem::path> scenarios;    ///< scenario files, applied after the config's overrides
  std::vector<std::filesystem::path> inputs;       ///< CSV files with values of unconnected inputs
  std::optional<double> stop_time_s;               ///< replaces the stop time of the config
  std::optional<WrittenTime> step_s;               ///< step for a single FMU, or for an SSP that defines none
  std::optional<std::vector<std::string>> record;  ///< patterns of names; replaces `variables` and `exclude`
  bool isolate = false;                            ///< run every instance in a separate process
  bool statistics = false;                         ///< measure calls and wall time of every instance
  std::optional<double> checkpoint_every_s;        ///< interval of the checkpoints in simulated time
  std::optional<bool> draws_calibration;           ///< replaces the setting "uncertainty" of the config

  void visit(state::Visitor& v);
};

}  // namespace mebots
