// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace mebots::master {

/// Compares the times of a signal file with the times at which a run uses its values.
class SignalCoverage {
 public:
  SignalCoverage(ResolvedSystem& system, std::string file) : system_(system), file_(std::move(file)) {}

  /// Checks one signal. Throws InputError if the run needs values before the first or after the last row and
  /// `description` does not permit this.
  void check(const OverrideDescription& description, const ResolvedVariable& variable, const Signal& signal);
  /// Adds notices about all checked signals to the system.
  void add_notices();

 private:
  struct Changes {
    // Number of changes of a signal that take effect only at the next communication point: its jumps and, if it is not
    // interpolated, all changes.
    std::size_t late = 0;
    std::size_t skipped = 0;
    std::size_t rows = 0;
    std::int64_t first_ns = 0;  // time of the first late change
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

/// Resolves and checks both ends of every connection in `system.description`. Stores the connections in
/// `system.connections`, sorted by target. Throws InputError if a connection is invalid. Throws InterruptedError after
/// an interrupt.
void resolve_connections(ResolvedSystem& system, const std::atomic<bool>& interrupted);

/// Reads the signal files of the system's `inputs` and scenario, each file once. Stores the signals in `inputs` and
/// `scenario_signals`. Adds notices about converted units, times without rows, and changes between communication
/// points. Throws InputError if a file, column, unit or value is wrong, or if an input has another source. Must be
/// called after resolve_connections().
void resolve_signals(ResolvedSystem& system);

/// Groups the model exchange instances into `system.continuous_systems`, and marks the connections inside these
/// systems. Throws InputError for settings that are not possible in such systems. Must be called after
/// resolve_connections() and resolve_signals().
void resolve_continuous_systems(ResolvedSystem& system);

/// Loads the FMUs that share this process. If an FMU cannot share it, runs its instances in separate processes and adds
/// the reason to `system.notices`. Throws InputError if the config requires `"process": "shared"` for such an instance,
/// or if a library cannot be loaded. Throws InterruptedError after an interrupt.
void choose_processes(ResolvedSystem& system, const std::atomic<bool>& interrupted);

}  // namespace mebots::master
