// SPDX-License-Identifier: Apache-2.0
// The cheapest FMU that can be connected: after a step y is the u that the step began with, and `sum` their sum.
// `work` makes a step longer by so many multiplications that depend on each other, to weigh threads.
#include "mebots/fmi2/functions.hpp"

#include <cstring>
#include <new>

namespace {

enum Reference : fmi2ValueReference { kU, kY, kSum, kRealCount };

struct Passthrough {
  fmi2Real reals[kRealCount] = {};
  fmi2Integer work = 0;
};

Passthrough& self(fmi2Component component) {
  return *static_cast<Passthrough*>(component);
}

}  // namespace

const char* fmi2GetTypesPlatform() {
  return "default";
}
const char* fmi2GetVersion() {
  return "2.0";
}
fmi2Status fmi2SetDebugLogging(fmi2Component, fmi2Boolean, std::size_t, const fmi2String[]) {
  return fmi2OK;
}
fmi2Component fmi2Instantiate(fmi2String, fmi2Type, fmi2String guid, fmi2String, const fmi2CallbackFunctions*,
                              fmi2Boolean, fmi2Boolean) {
  return std::strcmp(guid, "{passthrough}") == 0 ? new (std::nothrow) Passthrough : nullptr;
}
void fmi2FreeInstance(fmi2Component component) {
  delete static_cast<Passthrough*>(component);
}
fmi2Status fmi2SetupExperiment(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real) {
  return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component) {
  return fmi2OK;
}
fmi2Status fmi2ExitInitializationMode(fmi2Component) {
  return fmi2OK;
}
fmi2Status fmi2Terminate(fmi2Component) {
  return fmi2OK;
}
fmi2Status fmi2Reset(fmi2Component component) {
  self(component) = {};
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       fmi2Real values[]) {
  for (std::size_t i = 0; i < count; ++i) {
    if (references[i] >= kRealCount) return fmi2Error;
    values[i] = self(component).reals[references[i]];
  }
  return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       const fmi2Real values[]) {
  for (std::size_t i = 0; i < count; ++i) {
    if (references[i] != kU) return fmi2Error;
    self(component).reals[kU] = values[i];
  }
  return fmi2OK;
}
fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          fmi2Integer values[]) {
  for (std::size_t i = 0; i < count; ++i) {
    if (references[i] != 0) return fmi2Error;
    values[i] = self(component).work;
  }
  return fmi2OK;
}
fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                          const fmi2Integer values[]) {
  for (std::size_t i = 0; i < count; ++i) {
    if (references[i] != 0) return fmi2Error;
    self(component).work = values[i];
  }
  return fmi2OK;
}
fmi2Status fmi2GetBoolean(fmi2Component, const fmi2ValueReference[], std::size_t count, fmi2Boolean[]) {
  return count == 0 ? fmi2OK : fmi2Error;
}
fmi2Status fmi2SetBoolean(fmi2Component, const fmi2ValueReference[], std::size_t count, const fmi2Boolean[]) {
  return count == 0 ? fmi2OK : fmi2Error;
}
fmi2Status fmi2GetString(fmi2Component, const fmi2ValueReference[], std::size_t count, fmi2String[]) {
  return count == 0 ? fmi2OK : fmi2Error;
}
fmi2Status fmi2SetString(fmi2Component, const fmi2ValueReference[], std::size_t count, const fmi2String[]) {
  return count == 0 ? fmi2OK : fmi2Error;
}

// Not offered, but some tools load a library only with all functions of the standard.
fmi2Status fmi2GetFMUstate(fmi2Component, fmi2FMUstate*) {
  return fmi2Error;
}
fmi2Status fmi2SetFMUstate(fmi2Component, fmi2FMUstate) {
  return fmi2Error;
}
fmi2Status fmi2FreeFMUstate(fmi2Component, fmi2FMUstate*) {
  return fmi2Error;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate, std::size_t*) {
  return fmi2Error;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component, fmi2FMUstate, fmi2Byte[], std::size_t) {
  return fmi2Error;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component, const fmi2Byte[], std::size_t, fmi2FMUstate*) {
  return fmi2Error;
}
fmi2Status fmi2GetDirectionalDerivative(fmi2Component, const fmi2ValueReference[], std::size_t,
                                        const fmi2ValueReference[], std::size_t, const fmi2Real[], fmi2Real[]) {
  return fmi2Error;
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component, const fmi2ValueReference[], std::size_t, const fmi2Integer[],
                                       const fmi2Real[]) {
  return fmi2Error;
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component, const fmi2ValueReference[], std::size_t, const fmi2Integer[],
                                        fmi2Real[]) {
  return fmi2Error;
}
fmi2Status fmi2DoStep(fmi2Component component, fmi2Real, fmi2Real, fmi2Boolean) {
  Passthrough& p = self(component);
  fmi2Real x = p.reals[kU];
  for (fmi2Integer i = 0; i < p.work; ++i) x = 0.5 * x + p.reals[kU];
  p.reals[kY] = p.work == 0 ? p.reals[kU] : 0.5 * x;  // 0.5 x tends to u
  p.reals[kSum] += p.reals[kU];
  return fmi2OK;
}
fmi2Status fmi2CancelStep(fmi2Component) {
  return fmi2Error;
}
fmi2Status fmi2GetStatus(fmi2Component, fmi2StatusKind, fmi2Status*) {
  return fmi2Discard;
}
fmi2Status fmi2GetRealStatus(fmi2Component, fmi2StatusKind, fmi2Real*) {
  return fmi2Discard;
}
fmi2Status fmi2GetIntegerStatus(fmi2Component, fmi2StatusKind, fmi2Integer*) {
  return fmi2Discard;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component, fmi2StatusKind, fmi2Boolean*) {
  return fmi2Discard;
}
fmi2Status fmi2GetStringStatus(fmi2Component, fmi2StatusKind, fmi2String*) {
  return fmi2Discard;
}
