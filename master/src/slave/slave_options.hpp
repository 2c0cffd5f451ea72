// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/statistics.hpp"

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// An instance that failed on the way, while the others went on.
struct InstanceLoss {
  std::string name;
  std::optional<std::int64_t> at_ns = {};  ///< start of the step, or communication point, at which it failed
  std::string text;
};

class Scenario;

/// What stands between an ensemble and its slaves. All that is pointed to must outlive the ensemble.
struct SlaveOptions {
  Statistics* statistics = nullptr;                ///< where calls are counted; null = nowhere
  std::vector<InstanceLoss>* losses = nullptr;     ///< one per instance; null = every failure ends the run
  const Scenario* scenario = nullptr;              ///< changes variables on their way; null = nothing does
  const std::atomic<bool>* interrupted = nullptr;  ///< set by whoever wants the end; null = nobody does
};

}  // namespace mebots::master
