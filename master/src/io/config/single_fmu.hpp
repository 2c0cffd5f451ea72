// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/config/load_system.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "model/system_description.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::config {

/// Returns the config of a run of an FMU alone: one instance, named after the file. Times come from `times`, else from
/// the FMU's DefaultExperiment, else they run from 0 s to 1 s after the start in 500 steps. A stop time of the
/// DefaultExperiment is rounded down to a whole number of steps. Records the outputs, or the local variables of an FMU
/// that has no outputs. `notices` gets the values and where they come from. Throws InputError.
nlohmann::ordered_json single_fmu_config(const std::filesystem::path& fmu,
                                         const modeldesc::ModelDescription& description, const GivenTimes& times,
                                         std::vector<std::string>& notices);

}  // namespace mebots::master::config
