// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace mebots::master {

/// Compares the times of a file's rows with the times at which a run needs its signals.
class SignalCoverage {
 public:
  SignalCoverage(ResolvedSystem& system, std::string file) : system_(system), file_(std::move(file)) {}

  /// Checks one signal. Throws InputError if the run needs values at times outside of the file's rows, unless
  /// `description` permits that the first or last value applies there.
  void check(const OverrideDescription& description, const ResolvedVariable& variable, const Signal& signal);
  /// Appends the results of all calls to check() to the notices of the system.
  void add_notices();

 private:
  struct Changes {
    // Jumps, and changes of values that are not interpolated, that take effect only at the next point.
    std::size_t late = 0;
    std::size_t skipped = 0;
    std::size_t rows = 0;
    std::int64_t first_ns = 0;  // time of the first change that takes effect late
  };

  void check_rows(const ResolvedVariable& variable, const Signal& signal);

  ResolvedSystem& system_;
  std::string file_;
  bool starts_late_ = false;
  bool ends_early_ = false;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::map<std::size_t, Changes> changes_;  // indexed by instance
};

/// Resolves both ends of every connection in `system.description`, and checks that the ends match. Stores the
/// connections in `system.connections`, sorted by target instance. Throws InputError if a connection is invalid. Throws
/// InterruptedError after an interrupt.
void resolve_connections(ResolvedSystem& system, const std::atomic<bool>& interrupted);

/// Reads the signal files of the system's `inputs` and scenario, each file only once. Stores their signals in `inputs`
/// and `scenario_signals`. Adds notices about converted units, times at which the first or last value applies, and
/// changes between communication points. Throws InputError for files, columns, units and values that do not match, and
/// for inputs that have another source. Must be called after resolve_connections().
void resolve_signals(ResolvedSystem& system);

/// Groups the model exchange instances into `system.continuous_systems`, and marks the connections inside each of these
/// systems. Throws InputError for settings that such instances, or the members of one system, cannot have. Must be
/// called after resolve_connections() and resolve_signals().
void resolve_continuous_systems(ResolvedSystem& system);

/// Loads the FMUs that share this process. If an FMU cannot share it, its instances run in separate processes, and
/// `system.notices` contains the reason. Throws InputError if the config demands `"process": "shared"` for such an
/// instance, or if a library cannot be loaded. Throws InterruptedError if `interrupted` is set before a group of FMUs
/// is loaded.
void choose_processes(ResolvedSystem& system, const std::atomic<bool>& interrupted);

}  // namespace mebots::master
