// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "face.hpp"

#include <cstdint>
#include <string_view>

namespace mebots::shell {

/// The differences between versions of FMI in the code that the versions share. Most of them are names in messages.
struct Version {
  std::string_view prefix;               ///< of its functions
  std::string_view experiment_function;  ///< function that sets start and stop time
  std::string_view set_state_function;
  std::string_view initialising_functions;
  std::string_view step_state;          ///< name of State::step_complete
  std::string_view token_name;          ///< name of the build's identifier
  std::string_view Definition::*token;  ///< member that holds this build's identifier
  bool keeps_binaries;                  ///< the instance owns binary inputs, and its saved states contain them
};

inline constexpr Version kFmi2 = {
    .prefix = "fmi2",
    .experiment_function = "fmi2SetupExperiment",
    .set_state_function = "fmi2SetFMUstate",
    .initialising_functions = "fmi2SetupExperiment, fmi2EnterInitializationMode and fmi2ExitInitializationMode",
    .step_state = "step complete",
    .token_name = "GUID",
    .token = &Definition::guid,
    .keeps_binaries = false};

inline constexpr Version kFmi3 = {
    .prefix = "fmi3",
    .experiment_function = "fmi3EnterInitializationMode",
    .set_state_function = "fmi3SetFMUState",
    .initialising_functions = "fmi3EnterInitializationMode and fmi3ExitInitializationMode",
    .step_state = "step mode",
    .token_name = "instantiation token",
    .token = &Definition::instantiation_token,
    .keeps_binaries = true};

/// The values that fmi2Status and fmi3Status have in common.
enum class Status : std::uint8_t { ok, warning, discard, error, fatal };

}  // namespace mebots::shell
