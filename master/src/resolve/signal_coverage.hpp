// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace mebots::master {

/// Compares the rows of one file with the times at which a run needs its signals.
class SignalCoverage {
 public:
  SignalCoverage(ResolvedSystem& system, std::string file) : system_(system), file_(std::move(file)) {}

  /// Throws InputError if the run needs times that the file does not have, and the description does not let the first
  /// or last values hold there.
  void check(const OverrideDescription& description, const ResolvedVariable& variable, const Signal& signal);
  /// Adds what check() found to the system's notices.
  void tell();

 private:
  struct Changes {
    std::size_t late = 0;  // jumps, and changes of held values, that take effect at the next point only
    std::size_t skipped = 0;
    std::size_t rows = 0;
    std::int64_t first_ns = 0;  // of the late ones
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

/// Looks up both ends of every connection of `system.description`, checks that they fit, and fills
/// `system.connections`, in the order of the instances that they go to. Throws InputError, and InterruptedError.
void resolve_connections(ResolvedSystem& system, const std::atomic<bool>& interrupted);

/// Reads the files of signals that a system names under `inputs` and in its scenario, each once. Fills `inputs` and
/// `scenario_signals`. Notices say which units were converted, where values are held outside a file's rows, and which
/// changes fall between communication points. Throws InputError for files, columns, units and values that do not fit,
/// and for inputs that have another source. Comes after the connections.
void resolve_signals(ResolvedSystem& system);

/// Groups the instances of model exchange into `system.continuous_systems`, and marks the connections that lie within
/// one. Throws InputError for settings that instances of model exchange, or members of one system, cannot have. Comes
/// after the connections and signals.
void resolve_continuous_systems(ResolvedSystem& system);

/// Loads the FMUs that share this process. An instance whose FMU cannot share it gets its own process, and
/// `system.notices` says why. Throws InputError if the config demands `"process": "shared"` of such an instance or if a
/// library cannot be loaded, and InterruptedError between two FMUs.
void choose_processes(ResolvedSystem& system, const std::atomic<bool>& interrupted);

}  // namespace mebots::master
