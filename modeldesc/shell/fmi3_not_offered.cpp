// SPDX-License-Identifier: Apache-2.0
// The C functions of FMI 3.0 that MEbots' FMUs do not support. Each returns an error with the reason.
#include "fmi3_calls.hpp"

namespace mebots::shell {
namespace {

fmi3Status refuse(fmi3Instance handle, const char* function, const char* why) {
  return guarded3(handle, {function, legal::kAlive}, [&](Instance&) { throw Error(why); });
}

fmi3Status refuse_flag(fmi3Instance handle, const char* function, const char* flag) {
  return guarded3(handle, {function, legal::kAlive}, [&](Instance&) { not_offered(flag); });
}

fmi3Status refuse_model_exchange(fmi3Instance handle, const char* function) {
  return refuse(handle, function, "this is for model exchange, and this instance is one of co-simulation");
}

fmi3Status refuse_scheduled_execution(fmi3Instance handle, const char* function) {
  return refuse(handle, function, "this is for scheduled execution, and this instance is one of co-simulation");
}

fmi3Status refuse_event_mode(fmi3Instance handle, const char* function) {
  return refuse_flag(handle, function, "hasEventMode = false");
}

fmi3Status refuse_clocks(fmi3Instance handle, const char* function) {
  return refuse(handle, function, "this FMU has no clocks");
}

}  // namespace
}  // namespace mebots::shell

using mebots::Error;
using namespace mebots::shell;  // NOLINT(google-build-using-namespace): the functions below are the standard's, and
                                // global

// Model exchange.

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  return refuse_model_exchange(instance, "fmi3EnterContinuousTimeMode");
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean, fmi3Boolean*, fmi3Boolean*) {
  return refuse_model_exchange(instance, "fmi3CompletedIntegratorStep");
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64) {
  return refuse_model_exchange(instance, "fmi3SetTime");
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64[], std::size_t) {
  return refuse_model_exchange(instance, "fmi3SetContinuousStates");
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64[], std::size_t) {
  return refuse_model_exchange(instance, "fmi3GetContinuousStateDerivatives");
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64[], std::size_t) {
  return refuse_model_exchange(instance, "fmi3GetEventIndicators");
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64[], std::size_t) {
  return refuse_model_exchange(instance, "fmi3GetContinuousStates");
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64[], std::size_t) {
  return refuse_model_exchange(instance, "fmi3GetNominalsOfContinuousStates");
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, std::size_t*) {
  return refuse_model_exchange(instance, "fmi3GetNumberOfEventIndicators");
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, std::size_t*) {
  return refuse_model_exchange(instance, "fmi3GetNumberOfContinuousStates");
}

// Scheduled execution.

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference, fmi3Float64) {
  return refuse_scheduled_execution(instance, "fmi3ActivateModelPartition");
}

// Event mode.

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  return refuse_event_mode(instance, "fmi3EnterEventMode");
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  return refuse_event_mode(instance, "fmi3EnterStepMode");
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
  return refuse_event_mode(instance, "fmi3EvaluateDiscreteStates");
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean*, fmi3Boolean*, fmi3Boolean*, fmi3Boolean*,
                                    fmi3Boolean*, fmi3Float64*) {
  return refuse_event_mode(instance, "fmi3UpdateDiscreteStates");
}

// Clocks.

fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference[], std::size_t, fmi3Float64[],
                                  fmi3IntervalQualifier[]) {
  return refuse_clocks(instance, "fmi3GetIntervalDecimal");
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference[], std::size_t, fmi3UInt64[],
                                   fmi3UInt64[], fmi3IntervalQualifier[]) {
  return refuse_clocks(instance, "fmi3GetIntervalFraction");
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference[], std::size_t, fmi3Float64[]) {
  return refuse_clocks(instance, "fmi3GetShiftDecimal");
}

fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference[], std::size_t, fmi3UInt64[],
                                fmi3UInt64[]) {
  return refuse_clocks(instance, "fmi3GetShiftFraction");
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3Float64[]) {
  return refuse_clocks(instance, "fmi3SetIntervalDecimal");
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3UInt64[],
                                   const fmi3UInt64[]) {
  return refuse_clocks(instance, "fmi3SetIntervalFraction");
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3Float64[]) {
  return refuse_clocks(instance, "fmi3SetShiftDecimal");
}

fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3UInt64[],
                                const fmi3UInt64[]) {
  return refuse_clocks(instance, "fmi3SetShiftFraction");
}

// Derivatives and dependencies.

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3Int32[],
                                    fmi3Float64[], std::size_t) {
  return refuse_flag(instance, "fmi3GetOutputDerivatives", "maxOutputDerivativeOrder = 0");
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference[], std::size_t,
                                        const fmi3ValueReference[], std::size_t, const fmi3Float64[], std::size_t,
                                        fmi3Float64[], std::size_t) {
  return refuse_flag(instance, "fmi3GetDirectionalDerivative", "providesDirectionalDerivatives = false");
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference[], std::size_t,
                                    const fmi3ValueReference[], std::size_t, const fmi3Float64[], std::size_t,
                                    fmi3Float64[], std::size_t) {
  return refuse_flag(instance, "fmi3GetAdjointDerivative", "providesAdjointDerivatives = false");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference, std::size_t*) {
  return refuse_flag(instance, "fmi3GetNumberOfVariableDependencies", "providesPerElementDependencies = false");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference, std::size_t[], fmi3ValueReference[],
                                       std::size_t[], fmi3DependencyKind[], std::size_t) {
  return refuse_flag(instance, "fmi3GetVariableDependencies", "providesPerElementDependencies = false");
}
