// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"
#include "record/sink/row_block.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master {

/// Asks the slaves for the parameters that the system records. Once they are initialised.
std::vector<ParameterValue> read_parameters(const ResolvedSystem& system, Ensemble& ensemble);

/// Writes parameters.csv at t = 0: name, unit, value, one row per parameter. In a file of its own, since a
/// column per parameter would say the same at every row.
class ParameterRecorder final : public Observer {
 public:
  /// Throws InputError for a pattern that fits nothing.
  ParameterRecorder(const ResolvedSystem& system, Ensemble& ensemble, std::filesystem::path file);

  std::optional<std::string> reached(const Point& point) override;

 private:
  const ResolvedSystem* system_;
  Ensemble* ensemble_;
  std::filesystem::path file_;
};

}  // namespace mebots::master
