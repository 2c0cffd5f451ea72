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

/// The text of a value from `--set`; the type of the value is determined when the FMU is opened.
struct UntypedText {
  std::string text;

  void visit(state::Visitor& v);
};

/// A value to set. For a Boolean, it is true or false; for an enumeration, the name or the number of an item.
using Value = std::variant<double, std::int64_t, bool, std::string, UntypedText>;

/// Replaces a start value of the config.
struct Setting {
  std::string variable;  ///< "instance.variable"; * and ? select several
  Value value;
  std::string place;  ///< where the user wrote it, for error messages: "--set a.b=3"

  void visit(state::Visitor& v);
};

/// A time [s]: a number, or a ratio of whole numbers such as "1/60".
using WrittenTime = std::variant<double, std::string>;

/// Options of a run in addition to its config. The defaults write no files and keep the recorded rows in memory.
struct RunOptions {
  std::filesystem::path out;                       ///< folder for results.csv, summary.json, log.txt; empty = no files
  bool in_memory = true;                           ///< keep the recorded rows in memory
  std::vector<Setting> settings;                   ///< the last value for a variable counts
  std::vector<std::filesystem::path> scenarios;    ///< scenario files, applied after the config's overrides
  std::vector<std::filesystem::path> inputs;       ///< CSV files with signals for unconnected inputs, after the
                                                   ///< config's
  std::optional<double> stop_time_s;               ///< in place of the config's
  std::optional<WrittenTime> step_s;               ///< step for a single FMU, or for an SSP that defines none
  std::optional<std::vector<std::string>> record;  ///< name patterns, in place of `variables` and `exclude`
  bool isolate = false;                            ///< run every instance in a separate process
  bool statistics = false;                         ///< measure calls and wall time of every instance, for the summary
  std::optional<double> checkpoint_every_s;        ///< write a checkpoint to `out` every this much simulated time
  std::optional<bool> draws_calibration;           ///< run the missions of "uncertainty"; replaces the config's setting

  void visit(state::Visitor& v);
};

}  // namespace mebots
