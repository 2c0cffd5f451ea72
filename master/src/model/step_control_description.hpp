// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// Limits the coupling error of one communication step. The error is an integral over the step. Its limit is the
/// tolerance times the maximum length of a step.
struct CouplingTolerance {
  double relative = 1e-3;  ///< relative to the largest magnitude until now of the source's value or the bond's power
  double absolute = 1e-6;  ///< for an input, a multiple of its nominal value; for a bond, in the unit of its power
};

/// The tolerance of one input or power bond.
struct NamedTolerance {
  std::string name;                            ///< name of a bond, or "instance.input"
  std::optional<CouplingTolerance> tolerance;  ///< nullopt: the input or bond is not measured
  std::string place;
};

enum class Rollback {
  never,        ///< accepts a step that exceeds the tolerance and shortens the next step
  if_possible,  ///< repeats such a step with half the length, if all instances can restore their states
  required,
};

/// Settings of step control, which adapts the length of communication steps to the coupling error. Lengths are
/// multiples of the system's step. The defaults of the controller are those of ECCO (Sadjina, Kyllingstad, Skjong,
/// Pedersen 2017).
struct StepControlDescription {
  std::int64_t min_steps = 1;
  std::int64_t max_steps = 1;
  std::int64_t initial_steps = 1;
  CouplingTolerance tolerance;
  std::vector<NamedTolerance> tolerances;
  Rollback rollback = Rollback::never;
  double safety = 0.8;
  double min_factor = 0.2;  ///< smallest ratio of the lengths of two consecutive steps
  double max_factor = 1.5;
  double proportional_gain = 0.2;
  double integral_gain = 0.15;
  std::string place;
};

}  // namespace mebots::master
