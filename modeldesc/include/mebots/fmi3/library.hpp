// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi/find_functions.hpp"
#include "mebots/fmi3/functions.hpp"

namespace mebots::fmi3 {

/// States which FMUs cannot run without a function. `to_run`: all FMUs. `to_step`: FMUs for co-simulation.
/// `to_integrate`: FMUs for model exchange. `events`: FMUs for model exchange, and FMUs for co-simulation with an event
/// mode. `event_mode`: FMUs for co-simulation with an event mode. `always`: the standard requires the function of all
/// FMUs, but a run is possible without it. Other values: FMUs whose modelDescription.xml declares a capability or has
/// variables of a type.
enum class Need { to_run, to_step, to_integrate, events, event_mode, always, fmu_state, serialization };

/// Pointers to the FMI functions in the library of an FMU. A pointer is null if the library lacks the function.
struct Functions {
  using Byte = fmi3Byte;

  decltype(&fmi3GetVersion) get_version = nullptr;
  decltype(&fmi3SetDebugLogging) set_debug_logging = nullptr;
  decltype(&fmi3InstantiateModelExchange) instantiate_model_exchange = nullptr;
  decltype(&fmi3InstantiateCoSimulation) instantiate_co_simulation = nullptr;
  decltype(&fmi3FreeInstance) free_instance = nullptr;
  decltype(&fmi3EnterInitializationMode) enter_initialization_mode = nullptr;
  decltype(&fmi3ExitInitializationMode) exit_initialization_mode = nullptr;
  decltype(&fmi3EnterEventMode) enter_event_mode = nullptr;
  decltype(&fmi3Terminate) terminate = nullptr;
  decltype(&fmi3Reset) reset = nullptr;
  decltype(&fmi3EnterConfigurationMode) enter_configuration_mode = nullptr;
  decltype(&fmi3ExitConfigurationMode) exit_configuration_mode = nullptr;
  decltype(&fmi3GetFloat32) get_float32 = nullptr;
  decltype(&fmi3GetFloat64) get_float64 = nullptr;
  decltype(&fmi3GetInt8) get_int8 = nullptr;
  decltype(&fmi3GetUInt8) get_uint8 = nullptr;
  decltype(&fmi3GetInt16) get_int16 = nullptr;
  decltype(&fmi3GetUInt16) get_uint16 = nullptr;
  decltype(&fmi3GetInt32) get_int32 = nullptr;
  decltype(&fmi3GetUInt32) get_uint32 = nullptr;
  decltype(&fmi3GetInt64) get_int64 = nullptr;
  decltype(&fmi3GetUInt64) get_uint64 = nullptr;
  decltype(&fmi3GetBoolean) get_boolean = nullptr;
  decltype(&fmi3GetString) get_string = nullptr;
  decltype(&fmi3GetBinary) get_binary = nullptr;
  decltype(&fmi3GetClock) get_clock = nullptr;
  decltype(&fmi3SetFloat32) set_float32 = nullptr;
  decltype(&fmi3SetFloat64) set_float64 = nullptr;
  decltype(&fmi3SetInt8) set_int8 = nullptr;
  decltype(&fmi3SetUInt8) set_uint8 = nullptr;
  decltype(&fmi3SetInt16) set_int16 = nullptr;
  decltype(&fmi3SetUInt16) set_uint16 = nullptr;
  decltype(&fmi3SetInt32) set_int32 = nullptr;
  decltype(&fmi3SetUInt32) set_uint32 = nullptr;
  decltype(&fmi3SetInt64) set_int64 = nullptr;
  decltype(&fmi3SetUInt64) set_uint64 = nullptr;
  decltype(&fmi3SetBoolean) set_boolean = nullptr;
  decltype(&fmi3SetString) set_string = nullptr;
  decltype(&fmi3SetBinary) set_binary = nullptr;
  decltype(&fmi3SetClock) set_clock = nullptr;
  decltype(&fmi3GetFMUState) get_fmu_state = nullptr;
  decltype(&fmi3SetFMUState) set_fmu_state = nullptr;
  decltype(&fmi3FreeFMUState) free_fmu_state = nullptr;
  decltype(&fmi3SerializedFMUStateSize) serialized_fmu_state_size = nullptr;
  decltype(&fmi3SerializeFMUState) serialize_fmu_state = nullptr;
  decltype(&fmi3DeserializeFMUState) deserialize_fmu_state = nullptr;
  decltype(&fmi3GetDirectionalDerivative) get_directional_derivative = nullptr;
  decltype(&fmi3GetIntervalDecimal) get_interval_decimal = nullptr;
  decltype(&fmi3GetIntervalFraction) get_interval_fraction = nullptr;
  decltype(&fmi3GetShiftDecimal) get_shift_decimal = nullptr;
  decltype(&fmi3SetIntervalDecimal) set_interval_decimal = nullptr;
  decltype(&fmi3EvaluateDiscreteStates) evaluate_discrete_states = nullptr;
  decltype(&fmi3UpdateDiscreteStates) update_discrete_states = nullptr;
  decltype(&fmi3EnterContinuousTimeMode) enter_continuous_time_mode = nullptr;
  decltype(&fmi3CompletedIntegratorStep) completed_integrator_step = nullptr;
  decltype(&fmi3SetTime) set_time = nullptr;
  decltype(&fmi3SetContinuousStates) set_continuous_states = nullptr;
  decltype(&fmi3GetContinuousStateDerivatives) get_continuous_state_derivatives = nullptr;
  decltype(&fmi3GetEventIndicators) get_event_indicators = nullptr;
  decltype(&fmi3GetContinuousStates) get_continuous_states = nullptr;
  decltype(&fmi3GetNominalsOfContinuousStates) get_nominals_of_continuous_states = nullptr;
  decltype(&fmi3GetNumberOfEventIndicators) get_number_of_event_indicators = nullptr;
  decltype(&fmi3GetNumberOfContinuousStates) get_number_of_continuous_states = nullptr;
  decltype(&fmi3EnterStepMode) enter_step_mode = nullptr;
  decltype(&fmi3GetOutputDerivatives) get_output_derivatives = nullptr;
  decltype(&fmi3DoStep) do_step = nullptr;
};

/// Calls action(name, fmi::kMember<pointer to member>, Need) for each member of Functions.
template <typename Action>
void for_each_function(Action action) {
  using F = Functions;
  action("fmi3GetVersion", fmi::kMember<&F::get_version>, Need::to_run);
  action("fmi3SetDebugLogging", fmi::kMember<&F::set_debug_logging>, Need::always);
  action("fmi3InstantiateModelExchange", fmi::kMember<&F::instantiate_model_exchange>, Need::to_integrate);
  action("fmi3InstantiateCoSimulation", fmi::kMember<&F::instantiate_co_simulation>, Need::to_step);
  action("fmi3FreeInstance", fmi::kMember<&F::free_instance>, Need::to_run);
  action("fmi3EnterInitializationMode", fmi::kMember<&F::enter_initialization_mode>, Need::to_run);
  action("fmi3ExitInitializationMode", fmi::kMember<&F::exit_initialization_mode>, Need::to_run);
  action("fmi3EnterEventMode", fmi::kMember<&F::enter_event_mode>, Need::events);
  action("fmi3Terminate", fmi::kMember<&F::terminate>, Need::to_run);
  action("fmi3Reset", fmi::kMember<&F::reset>, Need::always);
  action("fmi3EnterConfigurationMode", fmi::kMember<&F::enter_configuration_mode>, Need::always);
  action("fmi3ExitConfigurationMode", fmi::kMember<&F::exit_configuration_mode>, Need::always);
  action("fmi3GetFloat32", fmi::kMember<&F::get_float32>, Need::always);
  action("fmi3GetFloat64", fmi::kMember<&F::get_float64>, Need::to_run);
  action("fmi3GetInt8", fmi::kMember<&F::get_int8>, Need::always);
  action("fmi3GetUInt8", fmi::kMember<&F::get_uint8>, Need::always);
  action("fmi3GetInt16", fmi::kMember<&F::get_int16>, Need::always);
  action("fmi3GetUInt16", fmi::kMember<&F::get_uint16>, Need::always);
  action("fmi3GetInt32", fmi::kMember<&F::get_int32>, Need::always);
  action("fmi3GetUInt32", fmi::kMember<&F::get_uint32>, Need::always);
  action("fmi3GetInt64", fmi::kMember<&F::get_int64>, Need::always);
  action("fmi3GetUInt64", fmi::kMember<&F::get_uint64>, Need::always);
  action("fmi3GetBoolean", fmi::kMember<&F::get_boolean>, Need::always);
  action("fmi3GetString", fmi::kMember<&F::get_string>, Need::always);
  action("fmi3GetBinary", fmi::kMember<&F::get_binary>, Need::always);
  action("fmi3GetClock", fmi::kMember<&F::get_clock>, Need::always);
  action("fmi3SetFloat32", fmi::kMember<&F::set_float32>, Need::always);
  action("fmi3SetFloat64", fmi::kMember<&F::set_float64>, Need::to_run);
  action("fmi3SetInt8", fmi::kMember<&F::set_int8>, Need::always);
  action("fmi3SetUInt8", fmi::kMember<&F::set_uint8>, Need::always);
  action("fmi3SetInt16", fmi::kMember<&F::set_int16>, Need::always);
  action("fmi3SetUInt16", fmi::kMember<&F::set_uint16>, Need::always);
  action("fmi3SetInt32", fmi::kMember<&F::set_int32>, Need::always);
  action("fmi3SetUInt32", fmi::kMember<&F::set_uint32>, Need::always);
  action("fmi3SetInt64", fmi::kMember<&F::set_int64>, Need::always);
  action("fmi3SetUInt64", fmi::kMember<&F::set_uint64>, Need::always);
  action("fmi3SetBoolean", fmi::kMember<&F::set_boolean>, Need::always);
  action("fmi3SetString", fmi::kMember<&F::set_string>, Need::always);
  action("fmi3SetBinary", fmi::kMember<&F::set_binary>, Need::always);
  action("fmi3SetClock", fmi::kMember<&F::set_clock>, Need::always);
  action("fmi3GetFMUState", fmi::kMember<&F::get_fmu_state>, Need::fmu_state);
  action("fmi3SetFMUState", fmi::kMember<&F::set_fmu_state>, Need::fmu_state);
  action("fmi3FreeFMUState", fmi::kMember<&F::free_fmu_state>, Need::fmu_state);
  action("fmi3SerializedFMUStateSize", fmi::kMember<&F::serialized_fmu_state_size>, Need::serialization);
  action("fmi3SerializeFMUState", fmi::kMember<&F::serialize_fmu_state>, Need::serialization);
  action("fmi3DeserializeFMUState", fmi::kMember<&F::deserialize_fmu_state>, Need::serialization);
  action("fmi3GetDirectionalDerivative", fmi::kMember<&F::get_directional_derivative>, Need::always);
  action("fmi3GetIntervalDecimal", fmi::kMember<&F::get_interval_decimal>, Need::always);
  action("fmi3GetIntervalFraction", fmi::kMember<&F::get_interval_fraction>, Need::always);
  action("fmi3GetShiftDecimal", fmi::kMember<&F::get_shift_decimal>, Need::always);
  action("fmi3SetIntervalDecimal", fmi::kMember<&F::set_interval_decimal>, Need::always);
  action("fmi3EvaluateDiscreteStates", fmi::kMember<&F::evaluate_discrete_states>, Need::always);
  action("fmi3UpdateDiscreteStates", fmi::kMember<&F::update_discrete_states>, Need::events);
  action("fmi3EnterContinuousTimeMode", fmi::kMember<&F::enter_continuous_time_mode>, Need::to_integrate);
  action("fmi3CompletedIntegratorStep", fmi::kMember<&F::completed_integrator_step>, Need::to_integrate);
  action("fmi3SetTime", fmi::kMember<&F::set_time>, Need::to_integrate);
  action("fmi3SetContinuousStates", fmi::kMember<&F::set_continuous_states>, Need::to_integrate);
  action("fmi3GetContinuousStateDerivatives", fmi::kMember<&F::get_continuous_state_derivatives>, Need::to_integrate);
  action("fmi3GetEventIndicators", fmi::kMember<&F::get_event_indicators>, Need::to_integrate);
  action("fmi3GetContinuousStates", fmi::kMember<&F::get_continuous_states>, Need::to_integrate);
  action("fmi3GetNominalsOfContinuousStates", fmi::kMember<&F::get_nominals_of_continuous_states>, Need::to_integrate);
  action("fmi3GetNumberOfEventIndicators", fmi::kMember<&F::get_number_of_event_indicators>, Need::to_integrate);
  action("fmi3GetNumberOfContinuousStates", fmi::kMember<&F::get_number_of_continuous_states>, Need::to_integrate);
  action("fmi3EnterStepMode", fmi::kMember<&F::enter_step_mode>, Need::event_mode);
  action("fmi3GetOutputDerivatives", fmi::kMember<&F::get_output_derivatives>, Need::always);
  action("fmi3DoStep", fmi::kMember<&F::do_step>, Need::to_step);
}

/// Looks up all members of Functions in a loaded library. `library` is its handle from dlopen(), or from LoadLibrary()
/// on Windows.
inline Functions find_functions(void* library) {
  return fmi::find_functions<Functions>(library, [](auto action) { for_each_function(action); });
}

}  // namespace mebots::fmi3
