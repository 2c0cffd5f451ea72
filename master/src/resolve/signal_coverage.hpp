// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace mebots::master {

/// Compares the rows of a file with the times at which a run needs its signals.
class SignalCoverage {
 public:
  SignalCoverage(ResolvedSystem& system, std::string file) : system_(system), file_(std::move(file)) {}

  /// Throws InputError if the run needs values at times outside of the file, and `description` does not permit holding
  /// the first or last value.
  void check(const OverrideDescription& description, const ResolvedVariable& variable, const Signal& signal);
  /// Adds the results of check() to the system's notices.
  void add_notices();

 private:
  struct Changes {
    std::size_t late = 0;  // jumps, and changes of held values, that take effect only at the next point
    std::size_t skipped = 0;
    std::size_t rows = 0;
    std::int64_t first_ns = 0;  // time of the first late one
  };

  void check_rows(const ResolvedVariable& variable, const Signal& signal);

  ResolvedSystem& system_;
  std::string file_;
  bool starts_late_ = false;
  bool ends_early_ = false;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::map<std::size_t, Changes> changes_;  // by instance
};

/// Resolves both ends of every connection of `system.description`, checks that they fit, and fills `system.connections`
/// in the order of the target instances. Throws InputError, and InterruptedError.
void resolve_connections(ResolvedSystem& system, const std::atomic<bool>& interrupted);

/// Reads the signal files of a system's `inputs` and scenario. Each file is read once. Fills `inputs` and
/// `scenario_signals`. Notices list converted units, times at which values are held outside of a file's rows, and
/// changes between communication points. Throws InputError for files, columns, units and values that do not fit, and
/// for inputs that have another source. Must be called after resolve_connections().
void resolve_signals(ResolvedSystem& system);

/// Groups the model exchange instances into `system.continuous_systems`, and marks the connections within each such
/// system. Throws InputError for settings that such instances, or members of one system, cannot have. Must be called
/// after resolve_connections() and resolve_signals().
void resolve_continuous_systems(ResolvedSystem& system);

/// Loads the FMUs that share this process. If an FMU cannot share this process, its instances get separate processes,
/// and `system.notices` contains the reason. Throws InputError if the config demands `"process": "shared"` for such an
/// instance, or if a library cannot be loaded. Checks `interrupted` before it loads a group of FMUs, and throws
/// InterruptedError if this flag is set.
void choose_processes(ResolvedSystem& system, const std::atomic<bool>& interrupted);

}  // namespace mebots::master
