// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi2/functions.hpp"

#include <string>

namespace mebots::master {

/// What fmi2GetTypesPlatform must say: the sizes of the standard's own header.
inline constexpr const char* kTypesPlatform = "default";

/// The functions of one loaded FMU. Those after `do_step` may be null: not every FMU brings them.
struct Fmi2Functions {
  decltype(&fmi2GetTypesPlatform) get_types_platform;
  decltype(&fmi2GetVersion) get_version;
  decltype(&fmi2Instantiate) instantiate;
  decltype(&fmi2FreeInstance) free_instance;
  decltype(&fmi2SetupExperiment) setup_experiment;
  decltype(&fmi2EnterInitializationMode) enter_initialization_mode;
  decltype(&fmi2ExitInitializationMode) exit_initialization_mode;
  decltype(&fmi2Terminate) terminate;
  decltype(&fmi2GetReal) get_real;
  decltype(&fmi2GetInteger) get_integer;
  decltype(&fmi2GetBoolean) get_boolean;
  decltype(&fmi2GetString) get_string;
  decltype(&fmi2SetReal) set_real;
  decltype(&fmi2SetInteger) set_integer;
  decltype(&fmi2SetBoolean) set_boolean;
  decltype(&fmi2SetString) set_string;
  decltype(&fmi2DoStep) do_step;

  decltype(&fmi2SetDebugLogging) set_debug_logging;
  decltype(&fmi2GetFMUstate) get_fmu_state;
  decltype(&fmi2SetFMUstate) set_fmu_state;
  decltype(&fmi2FreeFMUstate) free_fmu_state;
  decltype(&fmi2SerializedFMUstateSize) serialized_fmu_state_size;
  decltype(&fmi2SerializeFMUstate) serialize_fmu_state;
  decltype(&fmi2DeSerializeFMUstate) deserialize_fmu_state;
  decltype(&fmi2GetRealStatus) get_real_status;
  decltype(&fmi2GetBooleanStatus) get_boolean_status;
};

/// Looks the functions up in a library from dlopen. Throws InputError listing those that are missing;
/// `archive` names the FMU in it.
Fmi2Functions load_functions(void* library, const std::string& archive);

}  // namespace mebots::master
