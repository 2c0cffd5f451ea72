// SPDX-License-Identifier: Apache-2.0
// An FMU of FMI 3.0 that integrates its input. It commits the fault in its instantiation token: {culprit3:fault}.
#include "mebots/fmi3/functions.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

namespace {

struct Saved {
  double y = 0;
  double time = 0;
};

struct Instance : Saved {
  std::string crime;
  int events = 0;
};

double shared = 0;  // shared by all instances, for the crime "shared"

Instance& of(fmi3Instance instance) {
  return *static_cast<Instance*>(instance);
}

fmi3Instance instantiate(fmi3String token, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  auto made = std::make_unique<Instance>();
  const std::string text = token;
  made->crime = text.substr(text.find(':') + 1, text.size() - text.find(':') - 2);
  if (made->crime == "refuses") {
    log(environment, fmi3Error, "logStatusError", "no licence");
    return nullptr;
  }
  return made.release();
}

}  // namespace

const char* fmi3GetVersion() {
  return "3.0";
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String token, fmi3String, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, fmi3Boolean, const fmi3ValueReference[], std::size_t,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback) {
  return instantiate(token, environment, log);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String token, fmi3String, fmi3Boolean, fmi3Boolean,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  return instantiate(token, environment, log);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                               fmi3InstanceEnvironment, fmi3LogMessageCallback, fmi3ClockUpdateCallback,
                                               fmi3LockPreemptionCallback, fmi3UnlockPreemptionCallback) {
  return nullptr;
}

void fmi3FreeInstance(fmi3Instance instance) {
  delete static_cast<Instance*>(instance);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance, fmi3Boolean, std::size_t, const fmi3String[]) {
  return fmi3OK;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean, fmi3Float64, fmi3Float64 start, fmi3Boolean,
                                       fmi3Float64) {
  of(instance).time = start;
  return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance) {
  return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance) {
  return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance) {
  if (of(instance).crime != "keeps") static_cast<Saved&>(of(instance)) = {};
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 point, fmi3Float64 step, fmi3Boolean, fmi3Boolean* event,
                      fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* reached) {
  auto& own = of(instance);
  *event = *terminate = false;
  *early = own.crime == "early";
  if (own.crime == "crashes") std::abort();
  own.y += step * (1 + own.y * own.y);
  if (own.crime == "shared") own.y = shared += step;
  if (own.crime == "infinite") own.y = HUGE_VAL;
  own.time = point + step;
  *reached = own.crime == "past" ? point - step : own.time;
  return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {
  auto saved = std::make_unique<Saved>(of(instance));
  if (of(instance).crime == "forgets") saved->y = 0;
  *state = saved.release();
  return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  static_cast<Saved&>(of(instance)) = *static_cast<Saved*>(state);
  return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance, fmi3FMUState* state) {
  delete static_cast<Saved*>(*state);
  *state = nullptr;
  return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance, fmi3FMUState, std::size_t* size) {
  *size = sizeof(Saved);
  return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], std::size_t size) {
  if (of(instance).crime == "truncates") size = sizeof(double) / 2;
  std::memcpy(bytes, state, size);
  return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance, const fmi3Byte bytes[], std::size_t size, fmi3FMUState* state) {
  auto saved = std::make_unique<Saved>();
  std::memcpy(static_cast<void*>(saved.get()), bytes, size);
  *state = saved.release();
  return fmi3OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance) {
  return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* again, fmi3Boolean* terminate,
                                    fmi3Boolean* nominals, fmi3Boolean* values, fmi3Boolean* defined, fmi3Float64*) {
  *again = of(instance).crime == "endless" || of(instance).events++ == 0;
  *terminate = *nominals = *values = *defined = false;
  return fmi3OK;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance) {
  return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance, fmi3Boolean, fmi3Boolean* event, fmi3Boolean* terminate) {
  *event = *terminate = false;
  return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  of(instance).time = time;
  return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], std::size_t) {
  of(instance).y = states[0];
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[], std::size_t) {
  states[0] = of(instance).y;
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 derivatives[], std::size_t) {
  derivatives[0] = of(instance).crime == "divides" ? std::nan("") : 1 + of(instance).y;
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance, std::size_t* count) {
  *count = 1;
  return fmi3OK;
}

// Sets all requested elements to the value of the output.
#define MEBOTS_DEFINE(name, type)                                                                              \
  fmi3Status fmi3Get##name(fmi3Instance instance, const fmi3ValueReference[], std::size_t, type values[],      \
                           std::size_t count) {                                                                \
    for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<type>(of(instance).y);                     \
    return fmi3OK;                                                                                             \
  }                                                                                                            \
  fmi3Status fmi3Set##name(fmi3Instance, const fmi3ValueReference[], std::size_t, const type[], std::size_t) { \
    return fmi3OK;                                                                                             \
  }
MEBOTS_FMI3_EACH_NUMBER_TYPE(MEBOTS_DEFINE)

fmi3Status fmi3GetString(fmi3Instance, const fmi3ValueReference[], std::size_t, fmi3String[], std::size_t) {
  return fmi3Error;
}
fmi3Status fmi3SetString(fmi3Instance, const fmi3ValueReference[], std::size_t, const fmi3String[], std::size_t) {
  return fmi3Error;
}

// Functions that the FMU does not support.
fmi3Status fmi3EnterConfigurationMode(fmi3Instance) {
  return fmi3Error;
}
fmi3Status fmi3ExitConfigurationMode(fmi3Instance) {
  return fmi3Error;
}
fmi3Status fmi3GetBinary(fmi3Instance, const fmi3ValueReference[], std::size_t, std::size_t[], fmi3Binary[],
                         std::size_t) {
  return fmi3Error;
}
fmi3Status fmi3SetBinary(fmi3Instance, const fmi3ValueReference[], std::size_t, const std::size_t[], const fmi3Binary[],
                         std::size_t) {
  return fmi3Error;
}
fmi3Status fmi3GetClock(fmi3Instance, const fmi3ValueReference[], std::size_t, fmi3Clock[]) {
  return fmi3Error;
}
fmi3Status fmi3SetClock(fmi3Instance, const fmi3ValueReference[], std::size_t, const fmi3Clock[]) {
  return fmi3Error;
}
fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance, fmi3ValueReference, std::size_t*) {
  return fmi3Error;
}
fmi3Status fmi3GetVariableDependencies(fmi3Instance, fmi3ValueReference, std::size_t[], fmi3ValueReference[],
                                       std::size_t[], fmi3DependencyKind[], std::size_t) {
  return fmi3Error;
}
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance, const fmi3ValueReference[], std::size_t,
                                        const fmi3ValueReference[], std::size_t, const fmi3Float64[], std::size_t,
                                        fmi3Float64[], std::size_t) {
  return fmi3Error;
}
fmi3Status fmi3GetAdjointDerivative(fmi3Instance, const fmi3ValueReference[], std::size_t, const fmi3ValueReference[],
                                    std::size_t, const fmi3Float64[], std::size_t, fmi3Float64[], std::size_t) {
  return fmi3Error;
}
fmi3Status fmi3GetIntervalDecimal(fmi3Instance, const fmi3ValueReference[], std::size_t, fmi3Float64[],
                                  fmi3IntervalQualifier[]) {
  return fmi3Error;
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance, const fmi3ValueReference[], std::size_t, fmi3UInt64[], fmi3UInt64[],
                                   fmi3IntervalQualifier[]) {
  return fmi3Error;
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance, const fmi3ValueReference[], std::size_t, fmi3Float64[]) {
  return fmi3Error;
}
fmi3Status fmi3GetShiftFraction(fmi3Instance, const fmi3ValueReference[], std::size_t, fmi3UInt64[], fmi3UInt64[]) {
  return fmi3Error;
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance, const fmi3ValueReference[], std::size_t, const fmi3Float64[]) {
  return fmi3Error;
}
fmi3Status fmi3SetIntervalFraction(fmi3Instance, const fmi3ValueReference[], std::size_t, const fmi3UInt64[],
                                   const fmi3UInt64[]) {
  return fmi3Error;
}
fmi3Status fmi3SetShiftDecimal(fmi3Instance, const fmi3ValueReference[], std::size_t, const fmi3Float64[]) {
  return fmi3Error;
}
fmi3Status fmi3SetShiftFraction(fmi3Instance, const fmi3ValueReference[], std::size_t, const fmi3UInt64[],
                                const fmi3UInt64[]) {
  return fmi3Error;
}
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance) {
  return fmi3Error;
}
fmi3Status fmi3GetEventIndicators(fmi3Instance, fmi3Float64[], std::size_t) {
  return fmi3Error;
}
fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance, fmi3Float64[], std::size_t) {
  return fmi3Error;
}
fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance, std::size_t* count) {
  *count = 0;
  return fmi3OK;
}
fmi3Status fmi3EnterStepMode(fmi3Instance) {
  return fmi3Error;
}
fmi3Status fmi3GetOutputDerivatives(fmi3Instance, const fmi3ValueReference[], std::size_t, const fmi3Int32[],
                                    fmi3Float64[], std::size_t) {
  return fmi3Error;
}
fmi3Status fmi3ActivateModelPartition(fmi3Instance, fmi3ValueReference, fmi3Float64) {
  return fmi3Error;
}
