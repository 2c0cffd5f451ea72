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

/// Text of a value whose type is known only once the FMU is open, as `--set` gives it.
struct UntypedText {
  std::string text;

  void visit(state::Visitor& v);
};

/// A value to set: true and false for Booleans, item name or number for enumerations.
using Value = std::variant<double, std::int64_t, bool, std::string, UntypedText>;

/// A start value for a variable of the whole system, in place of the config's.
struct Setting {
  std::string variable;  ///< "instance.variable"
  Value value;
  std::string place;  ///< where it was written, for error messages: "--set a.b=3"

  void visit(state::Visitor& v);
};

/// A time: a number of seconds, or a ratio of whole numbers such as "1/60" [s].
using WrittenTime = std::variant<double, std::string>;

/// Options of a run beyond its config. The defaults write no files and keep the recorded rows in memory.
struct RunOptions {
  std::filesystem::path out;                       ///< folder for results.csv, summary.json, log.txt; empty = no files
  bool in_memory = true;                           ///< keep the recorded rows in memory
  std::vector<Setting> settings;                   ///< later ones win
  std::vector<std::filesystem::path> scenarios;    ///< overrides from files, after the config's
  std::vector<std::filesystem::path> inputs;       ///< CSV files with signals for free inputs, after the config's
  std::optional<double> stop_time_s;               ///< instead of the config's
  std::optional<WrittenTime> step_s;               ///< step, for an FMU alone or an SSP that has none
  std::optional<std::vector<std::string>> record;  ///< name patterns, in place of `variables` and `exclude`
  bool isolate = false;                            ///< every instance in a process of its own
  bool statistics = false;                         ///< measure calls and wall time of every instance, for the summary
  std::optional<double> checkpoint_every_s;        ///< checkpoints in `out`, after each such simulated time
  std::optional<bool> draws_calibration;           ///< fly the draws of "uncertainty", in place of the config's

  void visit(state::Visitor& v);
};

}  // namespace mebots
