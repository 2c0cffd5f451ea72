// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi/find_functions.hpp"
#include "mebots/fmi2/functions.hpp"

namespace mebots::fmi2 {

/// States which FMUs must export a function. A simulation is impossible without functions with `to_run` (all FMUs),
/// `to_step` (FMUs for co-simulation) and `to_integrate` (FMUs for model exchange). The standard also requires
/// functions with `always` (all FMUs) and `co_simulation` (FMUs for co-simulation). Other values: FMUs whose
/// modelDescription.xml declares a capability.
enum class Need {
  to_run,
  always,
  to_step,
  co_simulation,
  to_integrate,
  fmu_state,
  serialization,
  directional_derivative
};

/// Pointers to the FMI functions in the library of an FMU. A pointer is null if the library lacks the function.
struct Functions {
  using Byte = fmi2Byte;

  decltype(&fmi2GetTypesPlatform) get_types_platform = nullptr;
  decltype(&fmi2GetVersion) get_version = nullptr;
  decltype(&fmi2SetDebugLogging) set_debug_logging = nullptr;
  decltype(&fmi2Instantiate) instantiate = nullptr;
  decltype(&fmi2FreeInstance) free_instance = nullptr;
  decltype(&fmi2SetupExperiment) setup_experiment = nullptr;
  decltype(&fmi2EnterInitializationMode) enter_initialization_mode = nullptr;
  decltype(&fmi2ExitInitializationMode) exit_initialization_mode = nullptr;
  decltype(&fmi2Terminate) terminate = nullptr;
  decltype(&fmi2Reset) reset = nullptr;
  decltype(&fmi2GetReal) get_real = nullptr;
  decltype(&fmi2GetInteger) get_integer = nullptr;
  decltype(&fmi2GetBoolean) get_boolean = nullptr;
  decltype(&fmi2GetString) get_string = nullptr;
  decltype(&fmi2SetReal) set_real = nullptr;
  decltype(&fmi2SetInteger) set_integer = nullptr;
  decltype(&fmi2SetBoolean) set_boolean = nullptr;
  decltype(&fmi2SetString) set_string = nullptr;
  decltype(&fmi2GetFMUstate) get_fmu_state = nullptr;
  decltype(&fmi2SetFMUstate) set_fmu_state = nullptr;
  decltype(&fmi2FreeFMUstate) free_fmu_state = nullptr;
  decltype(&fmi2SerializedFMUstateSize) serialized_fmu_state_size = nullptr;
  decltype(&fmi2SerializeFMUstate) serialize_fmu_state = nullptr;
  decltype(&fmi2DeSerializeFMUstate) deserialize_fmu_state = nullptr;
  decltype(&fmi2GetDirectionalDerivative) get_directional_derivative = nullptr;
  decltype(&fmi2SetRealInputDerivatives) set_real_input_derivatives = nullptr;
  decltype(&fmi2GetRealOutputDerivatives) get_real_output_derivatives = nullptr;
  decltype(&fmi2DoStep) do_step = nullptr;
  decltype(&fmi2CancelStep) cancel_step = nullptr;
  decltype(&fmi2GetStatus) get_status = nullptr;
  decltype(&fmi2GetRealStatus) get_real_status = nullptr;
  decltype(&fmi2GetIntegerStatus) get_integer_status = nullptr;
  decltype(&fmi2GetBooleanStatus) get_boolean_status = nullptr;
  decltype(&fmi2GetStringStatus) get_string_status = nullptr;
  decltype(&fmi2EnterEventMode) enter_event_mode = nullptr;
  decltype(&fmi2NewDiscreteStates) new_discrete_states = nullptr;
  decltype(&fmi2EnterContinuousTimeMode) enter_continuous_time_mode = nullptr;
  decltype(&fmi2CompletedIntegratorStep) completed_integrator_step = nullptr;
  decltype(&fmi2SetTime) set_time = nullptr;
  decltype(&fmi2SetContinuousStates) set_continuous_states = nullptr;
  decltype(&fmi2GetDerivatives) get_derivatives = nullptr;
  decltype(&fmi2GetEventIndicators) get_event_indicators = nullptr;
  decltype(&fmi2GetContinuousStates) get_continuous_states = nullptr;
  decltype(&fmi2GetNominalsOfContinuousStates) get_nominals_of_continuous_states = nullptr;
};

/// Calls action(name, fmi::kMember<pointer to member>, Need) for each member of Functions.
template <typename Action>
void for_each_function(Action action) {
  using F = Functions;
  action("fmi2GetTypesPlatform", fmi::kMember<&F::get_types_platform>, Need::to_run);
  action("fmi2GetVersion", fmi::kMember<&F::get_version>, Need::to_run);
  action("fmi2SetDebugLogging", fmi::kMember<&F::set_debug_logging>, Need::always);
  action("fmi2Instantiate", fmi::kMember<&F::instantiate>, Need::to_run);
  action("fmi2FreeInstance", fmi::kMember<&F::free_instance>, Need::to_run);
  action("fmi2SetupExperiment", fmi::kMember<&F::setup_experiment>, Need::to_run);
  action("fmi2EnterInitializationMode", fmi::kMember<&F::enter_initialization_mode>, Need::to_run);
  action("fmi2ExitInitializationMode", fmi::kMember<&F::exit_initialization_mode>, Need::to_run);
  action("fmi2Terminate", fmi::kMember<&F::terminate>, Need::to_run);
  action("fmi2Reset", fmi::kMember<&F::reset>, Need::always);
  action("fmi2GetReal", fmi::kMember<&F::get_real>, Need::to_run);
  action("fmi2GetInteger", fmi::kMember<&F::get_integer>, Need::to_run);
  action("fmi2GetBoolean", fmi::kMember<&F::get_boolean>, Need::to_run);
  action("fmi2GetString", fmi::kMember<&F::get_string>, Need::to_run);
  action("fmi2SetReal", fmi::kMember<&F::set_real>, Need::to_run);
  action("fmi2SetInteger", fmi::kMember<&F::set_integer>, Need::to_run);
  action("fmi2SetBoolean", fmi::kMember<&F::set_boolean>, Need::to_run);
  action("fmi2SetString", fmi::kMember<&F::set_string>, Need::to_run);
  action("fmi2GetFMUstate", fmi::kMember<&F::get_fmu_state>, Need::fmu_state);
  action("fmi2SetFMUstate", fmi::kMember<&F::set_fmu_state>, Need::fmu_state);
  action("fmi2FreeFMUstate", fmi::kMember<&F::free_fmu_state>, Need::fmu_state);
  action("fmi2SerializedFMUstateSize", fmi::kMember<&F::serialized_fmu_state_size>, Need::serialization);
  action("fmi2SerializeFMUstate", fmi::kMember<&F::serialize_fmu_state>, Need::serialization);
  action("fmi2DeSerializeFMUstate", fmi::kMember<&F::deserialize_fmu_state>, Need::serialization);
  action("fmi2GetDirectionalDerivative", fmi::kMember<&F::get_directional_derivative>, Need::directional_derivative);
  action("fmi2SetRealInputDerivatives", fmi::kMember<&F::set_real_input_derivatives>, Need::co_simulation);
  action("fmi2GetRealOutputDerivatives", fmi::kMember<&F::get_real_output_derivatives>, Need::co_simulation);
  action("fmi2DoStep", fmi::kMember<&F::do_step>, Need::to_step);
  action("fmi2CancelStep", fmi::kMember<&F::cancel_step>, Need::co_simulation);
  action("fmi2GetStatus", fmi::kMember<&F::get_status>, Need::co_simulation);
  action("fmi2GetRealStatus", fmi::kMember<&F::get_real_status>, Need::co_simulation);
  action("fmi2GetIntegerStatus", fmi::kMember<&F::get_integer_status>, Need::co_simulation);
  action("fmi2GetBooleanStatus", fmi::kMember<&F::get_boolean_status>, Need::co_simulation);
  action("fmi2GetStringStatus", fmi::kMember<&F::get_string_status>, Need::co_simulation);
  action("fmi2EnterEventMode", fmi::kMember<&F::enter_event_mode>, Need::to_integrate);
  action("fmi2NewDiscreteStates", fmi::kMember<&F::new_discrete_states>, Need::to_integrate);
  action("fmi2EnterContinuousTimeMode", fmi::kMember<&F::enter_continuous_time_mode>, Need::to_integrate);
  action("fmi2CompletedIntegratorStep", fmi::kMember<&F::completed_integrator_step>, Need::to_integrate);
  action("fmi2SetTime", fmi::kMember<&F::set_time>, Need::to_integrate);
  action("fmi2SetContinuousStates", fmi::kMember<&F::set_continuous_states>, Need::to_integrate);
  action("fmi2GetDerivatives", fmi::kMember<&F::get_derivatives>, Need::to_integrate);
  action("fmi2GetEventIndicators", fmi::kMember<&F::get_event_indicators>, Need::to_integrate);
  action("fmi2GetContinuousStates", fmi::kMember<&F::get_continuous_states>, Need::to_integrate);
  action("fmi2GetNominalsOfContinuousStates", fmi::kMember<&F::get_nominals_of_continuous_states>, Need::to_integrate);
}

/// Looks up all members of Functions in a loaded library. `library` is its handle from dlopen(), or from LoadLibrary()
/// on Windows.
inline Functions find_functions(void* library) {
  return fmi::find_functions<Functions>(library, [](auto action) { for_each_function(action); });
}

}  // namespace mebots::fmi2
