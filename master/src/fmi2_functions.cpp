// SPDX-License-Identifier: Apache-2.0
#include "fmi2_functions.hpp"

#include "mebots/master/input_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <dlfcn.h>

#include <vector>

namespace mebots::master {

Fmi2Functions load_functions(void* library, const std::string& archive) {
  Fmi2Functions functions{};
  std::vector<std::string> missing;
  const auto optional = [&](auto*& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
    return function != nullptr;
  };
  const auto required = [&](auto*& function, const char* name) {
    if (!optional(function, name)) missing.emplace_back(name);
  };
  required(functions.get_types_platform, "fmi2GetTypesPlatform");
  required(functions.get_version, "fmi2GetVersion");
  required(functions.instantiate, "fmi2Instantiate");
  required(functions.free_instance, "fmi2FreeInstance");
  required(functions.setup_experiment, "fmi2SetupExperiment");
  required(functions.enter_initialization_mode, "fmi2EnterInitializationMode");
  required(functions.exit_initialization_mode, "fmi2ExitInitializationMode");
  required(functions.terminate, "fmi2Terminate");
  required(functions.get_real, "fmi2GetReal");
  required(functions.get_integer, "fmi2GetInteger");
  required(functions.get_boolean, "fmi2GetBoolean");
  required(functions.get_string, "fmi2GetString");
  required(functions.set_real, "fmi2SetReal");
  required(functions.set_integer, "fmi2SetInteger");
  required(functions.set_boolean, "fmi2SetBoolean");
  required(functions.set_string, "fmi2SetString");
  required(functions.do_step, "fmi2DoStep");
  optional(functions.set_debug_logging, "fmi2SetDebugLogging");
  optional(functions.get_fmu_state, "fmi2GetFMUstate");
  optional(functions.set_fmu_state, "fmi2SetFMUstate");
  optional(functions.free_fmu_state, "fmi2FreeFMUstate");
  optional(functions.serialized_fmu_state_size, "fmi2SerializedFMUstateSize");
  optional(functions.serialize_fmu_state, "fmi2SerializeFMUstate");
  optional(functions.deserialize_fmu_state, "fmi2DeSerializeFMUstate");
  optional(functions.get_real_status, "fmi2GetRealStatus");
  optional(functions.get_boolean_status, "fmi2GetBooleanStatus");
  if (!missing.empty()) {
    throw InputError(fmt::format("{}: the FMU's shared library lacks functions that FMI 2.0 demands: {}", archive,
                                 fmt::join(missing, ", ")));
  }
  return functions;
}

}  // namespace mebots::master
