// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi2/types.hpp"

/// Declares the functions that an FMI 2.0 FMU exports. A program that loads them at run time needs only their types,
/// such as `decltype(&fmi2DoStep)`.
#define MEBOTS_FMI2_EXPORT __attribute__((visibility("default")))

extern "C" {

MEBOTS_FMI2_EXPORT const char* fmi2GetTypesPlatform();
MEBOTS_FMI2_EXPORT const char* fmi2GetVersion();
MEBOTS_FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component, fmi2Boolean logging_on, std::size_t category_count,
                                                  const fmi2String categories[]);

MEBOTS_FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String instance_name, fmi2Type type, fmi2String guid,
                                                 fmi2String resource_location, const fmi2CallbackFunctions* functions,
                                                 fmi2Boolean visible, fmi2Boolean logging_on);
MEBOTS_FMI2_EXPORT void fmi2FreeInstance(fmi2Component);

MEBOTS_FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                                  fmi2Real start_time, fmi2Boolean stop_time_defined,
                                                  fmi2Real stop_time);
MEBOTS_FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component);
MEBOTS_FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component);
MEBOTS_FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component);
MEBOTS_FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component);

MEBOTS_FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component, const fmi2ValueReference references[], std::size_t count,
                                          fmi2Real values[]);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetInteger(fmi2Component, const fmi2ValueReference references[], std::size_t count,
                                             fmi2Integer values[]);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetBoolean(fmi2Component, const fmi2ValueReference references[], std::size_t count,
                                             fmi2Boolean values[]);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetString(fmi2Component, const fmi2ValueReference references[], std::size_t count,
                                            fmi2String values[]);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component, const fmi2ValueReference references[], std::size_t count,
                                          const fmi2Real values[]);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SetInteger(fmi2Component, const fmi2ValueReference references[], std::size_t count,
                                             const fmi2Integer values[]);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SetBoolean(fmi2Component, const fmi2ValueReference references[], std::size_t count,
                                             const fmi2Boolean values[]);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SetString(fmi2Component, const fmi2ValueReference references[], std::size_t count,
                                            const fmi2String values[]);

MEBOTS_FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component, fmi2FMUstate* state);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component, fmi2FMUstate state);
MEBOTS_FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component, fmi2FMUstate* state);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate state, std::size_t* size);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component, fmi2FMUstate state, fmi2Byte bytes[],
                                                    std::size_t size);
MEBOTS_FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component, const fmi2Byte bytes[], std::size_t size,
                                                      fmi2FMUstate* state);

MEBOTS_FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component, const fmi2ValueReference unknowns[],
                                                           std::size_t unknown_count, const fmi2ValueReference knowns[],
                                                           std::size_t known_count,
                                                           const fmi2Real known_differentials[],
                                                           fmi2Real unknown_differentials[]);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component, const fmi2ValueReference references[],
                                                          std::size_t count, const fmi2Integer orders[],
                                                          const fmi2Real values[]);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component, const fmi2ValueReference references[],
                                                           std::size_t count, const fmi2Integer orders[],
                                                           fmi2Real values[]);

MEBOTS_FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component, fmi2Real current_point, fmi2Real step_size,
                                         fmi2Boolean no_set_state_before_current_point);
MEBOTS_FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetStatus(fmi2Component, fmi2StatusKind kind, fmi2Status* value);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component, fmi2StatusKind kind, fmi2Real* value);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component, fmi2StatusKind kind, fmi2Integer* value);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component, fmi2StatusKind kind, fmi2Boolean* value);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component, fmi2StatusKind kind, fmi2String* value);

MEBOTS_FMI2_EXPORT fmi2Status fmi2EnterEventMode(fmi2Component);
MEBOTS_FMI2_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component, fmi2EventInfo* info);
MEBOTS_FMI2_EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component);
MEBOTS_FMI2_EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component, fmi2Boolean no_set_state_before_current_point,
                                                          fmi2Boolean* enter_event_mode, fmi2Boolean* terminate);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SetTime(fmi2Component, fmi2Real time);
MEBOTS_FMI2_EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component, const fmi2Real states[], std::size_t count);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetDerivatives(fmi2Component, fmi2Real derivatives[], std::size_t count);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component, fmi2Real indicators[], std::size_t count);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component, fmi2Real states[], std::size_t count);
MEBOTS_FMI2_EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component, fmi2Real nominals[], std::size_t count);

}  // extern "C"
