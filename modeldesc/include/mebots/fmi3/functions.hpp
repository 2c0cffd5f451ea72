// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi3/types.hpp"

/// Declares the functions that an FMI 3.0 FMU exports, for all three kinds of FMU. A program that loads them at run
/// time needs only their types, such as `decltype(&fmi3DoStep)`.
#define MEBOTS_FMI3_EXPORT __attribute__((visibility("default")))

/// Calls action(C name of the type, C type) for each type whose values are arrays of fixed-size elements.
#define MEBOTS_FMI3_EACH_NUMBER_TYPE(action)                                                                  \
  action(Float32, fmi3Float32) action(Float64, fmi3Float64) action(Int8, fmi3Int8) action(UInt8, fmi3UInt8)   \
      action(Int16, fmi3Int16) action(UInt16, fmi3UInt16) action(Int32, fmi3Int32) action(UInt32, fmi3UInt32) \
          action(Int64, fmi3Int64) action(UInt64, fmi3UInt64) action(Boolean, fmi3Boolean)

extern "C" {

MEBOTS_FMI3_EXPORT const char* fmi3GetVersion();
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance, fmi3Boolean logging_on, std::size_t category_count,
                                                  const fmi3String categories[]);

MEBOTS_FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String instance_name, fmi3String instantiation_token,
                                                             fmi3String resource_path, fmi3Boolean visible,
                                                             fmi3Boolean logging_on,
                                                             fmi3InstanceEnvironment environment,
                                                             fmi3LogMessageCallback log_message);
MEBOTS_FMI3_EXPORT fmi3Instance
fmi3InstantiateCoSimulation(fmi3String instance_name, fmi3String instantiation_token, fmi3String resource_path,
                            fmi3Boolean visible, fmi3Boolean logging_on, fmi3Boolean event_mode_used,
                            fmi3Boolean early_return_allowed, const fmi3ValueReference intermediate_variables[],
                            std::size_t intermediate_count, fmi3InstanceEnvironment environment,
                            fmi3LogMessageCallback log_message, fmi3IntermediateUpdateCallback intermediate_update);
MEBOTS_FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instance_name, fmi3String instantiation_token, fmi3String resource_path, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message,
    fmi3ClockUpdateCallback clock_update, fmi3LockPreemptionCallback lock_preemption,
    fmi3UnlockPreemptionCallback unlock_preemption);
MEBOTS_FMI3_EXPORT void fmi3FreeInstance(fmi3Instance);

MEBOTS_FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance, fmi3Boolean tolerance_defined,
                                                          fmi3Float64 tolerance, fmi3Float64 start_time,
                                                          fmi3Boolean stop_time_defined, fmi3Float64 stop_time);
MEBOTS_FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance);
MEBOTS_FMI3_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance);
MEBOTS_FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance);
MEBOTS_FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance);
MEBOTS_FMI3_EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance);
MEBOTS_FMI3_EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance);

#define MEBOTS_FMI3_DECLARE(name, type)                                                                               \
  MEBOTS_FMI3_EXPORT fmi3Status fmi3Get##name(fmi3Instance, const fmi3ValueReference references[], std::size_t count, \
                                              type values[], std::size_t value_count);                                \
  MEBOTS_FMI3_EXPORT fmi3Status fmi3Set##name(fmi3Instance, const fmi3ValueReference references[], std::size_t count, \
                                              const type values[], std::size_t value_count);
MEBOTS_FMI3_EACH_NUMBER_TYPE(MEBOTS_FMI3_DECLARE)
MEBOTS_FMI3_DECLARE(String, fmi3String)
#undef MEBOTS_FMI3_DECLARE

MEBOTS_FMI3_EXPORT fmi3Status fmi3GetBinary(fmi3Instance, const fmi3ValueReference references[], std::size_t count,
                                            std::size_t sizes[], fmi3Binary values[], std::size_t value_count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance, const fmi3ValueReference references[], std::size_t count,
                                            const std::size_t sizes[], const fmi3Binary values[],
                                            std::size_t value_count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance, const fmi3ValueReference references[], std::size_t count,
                                           fmi3Clock values[]);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance, const fmi3ValueReference references[], std::size_t count,
                                           const fmi3Clock values[]);

MEBOTS_FMI3_EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance, fmi3ValueReference reference,
                                                                  std::size_t* count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance, fmi3ValueReference dependent,
                                                          std::size_t dependent_elements[],
                                                          fmi3ValueReference independents[],
                                                          std::size_t independent_elements[],
                                                          fmi3DependencyKind kinds[], std::size_t count);

MEBOTS_FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance, fmi3FMUState* state);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance, fmi3FMUState state);
MEBOTS_FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance, fmi3FMUState* state);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance, fmi3FMUState state, std::size_t* size);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance, fmi3FMUState state, fmi3Byte bytes[],
                                                    std::size_t size);
MEBOTS_FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance, const fmi3Byte bytes[], std::size_t size,
                                                      fmi3FMUState* state);

MEBOTS_FMI3_EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance, const fmi3ValueReference unknowns[],
                                                           std::size_t unknown_count, const fmi3ValueReference knowns[],
                                                           std::size_t known_count, const fmi3Float64 seed[],
                                                           std::size_t seed_count, fmi3Float64 sensitivity[],
                                                           std::size_t sensitivity_count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance, const fmi3ValueReference unknowns[],
                                                       std::size_t unknown_count, const fmi3ValueReference knowns[],
                                                       std::size_t known_count, const fmi3Float64 seed[],
                                                       std::size_t seed_count, fmi3Float64 sensitivity[],
                                                       std::size_t sensitivity_count);

MEBOTS_FMI3_EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance, const fmi3ValueReference references[],
                                                     std::size_t count, fmi3Float64 intervals[],
                                                     fmi3IntervalQualifier qualifiers[]);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance, const fmi3ValueReference references[],
                                                      std::size_t count, fmi3UInt64 counters[],
                                                      fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance, const fmi3ValueReference references[],
                                                  std::size_t count, fmi3Float64 shifts[]);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetShiftFraction(fmi3Instance, const fmi3ValueReference references[],
                                                   std::size_t count, fmi3UInt64 counters[], fmi3UInt64 resolutions[]);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance, const fmi3ValueReference references[],
                                                     std::size_t count, const fmi3Float64 intervals[]);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetIntervalFraction(fmi3Instance, const fmi3ValueReference references[],
                                                      std::size_t count, const fmi3UInt64 counters[],
                                                      const fmi3UInt64 resolutions[]);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance, const fmi3ValueReference references[],
                                                  std::size_t count, const fmi3Float64 shifts[]);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetShiftFraction(fmi3Instance, const fmi3ValueReference references[],
                                                   std::size_t count, const fmi3UInt64 counters[],
                                                   const fmi3UInt64 resolutions[]);

MEBOTS_FMI3_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance);
MEBOTS_FMI3_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance, fmi3Boolean* discrete_states_need_update,
                                                       fmi3Boolean* terminate_simulation,
                                                       fmi3Boolean* nominals_of_continuous_states_changed,
                                                       fmi3Boolean* values_of_continuous_states_changed,
                                                       fmi3Boolean* next_event_time_defined,
                                                       fmi3Float64* next_event_time);

// Functions for model exchange.
MEBOTS_FMI3_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance);
MEBOTS_FMI3_EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance, fmi3Boolean no_set_state_before_current_point,
                                                          fmi3Boolean* enter_event_mode,
                                                          fmi3Boolean* terminate_simulation);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetTime(fmi3Instance, fmi3Float64 time);
MEBOTS_FMI3_EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance, const fmi3Float64 states[], std::size_t count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance, fmi3Float64 derivatives[],
                                                                std::size_t count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance, fmi3Float64 indicators[], std::size_t count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance, fmi3Float64 states[], std::size_t count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance, fmi3Float64 nominals[],
                                                                std::size_t count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance, std::size_t* count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance, std::size_t* count);

// Functions for co-simulation.
MEBOTS_FMI3_EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance);
MEBOTS_FMI3_EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance, const fmi3ValueReference references[],
                                                       std::size_t count, const fmi3Int32 orders[],
                                                       fmi3Float64 values[], std::size_t value_count);
MEBOTS_FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance, fmi3Float64 current_point, fmi3Float64 step_size,
                                         fmi3Boolean no_set_state_before_current_point,
                                         fmi3Boolean* event_handling_needed, fmi3Boolean* terminate_simulation,
                                         fmi3Boolean* early_return, fmi3Float64* last_successful_time);

// Functions for scheduled execution.
MEBOTS_FMI3_EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance, fmi3ValueReference clock_reference,
                                                         fmi3Float64 activation_time);

}  // extern "C"
