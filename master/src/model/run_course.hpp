// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/run_state.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

/// The arguments of fmi2SetupExperiment.
struct Experiment {
  std::int64_t start_ns = 0;
  std::optional<std::int64_t> stop_ns = {};  ///< if absent, stopTimeDefined is fmi2False
  std::optional<double> tolerance = {};      ///< if absent, toleranceDefined is fmi2False
};

/// A communication point that all instances have reached.
struct Point {
  std::int64_t step = 0;  ///< index of the point on the grid
  std::int64_t time_ns = 0;
};

struct End {
  EndReason reason = EndReason::stop_time;
  std::string text;  ///< a sentence for users
};

/// Describes an instance that failed while the run continued.
struct InstanceLoss {
  std::string name;
  /// The start of the failed step or, if another call failed, the communication point. Nullopt if the instance has not
  /// failed.
  std::optional<std::int64_t> at_ns = {};
  std::string text;
};

}  // namespace mebots::master
