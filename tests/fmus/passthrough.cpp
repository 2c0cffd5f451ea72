// SPDX-License-Identifier: Apache-2.0
// The cheapest FMU that can be connected. After a step, y is the u at the start of the step, and `sum` is the sum of
// all y. `work` lengthens a step by this number of dependent multiplications, for measurements with threads.
#include "mebots/fmi2/functions.hpp"

#include "frame.h"

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

FMI2_VERSIONS

fmi2Component fmi2Instantiate(fmi2String, fmi2Type, fmi2String guid, fmi2String, const fmi2CallbackFunctions*,
                              fmi2Boolean, fmi2Boolean) {
  return std::strcmp(guid, "{passthrough}") == 0 ? new (std::nothrow) Passthrough : nullptr;
}
void fmi2FreeInstance(fmi2Component component) {
  delete static_cast<Passthrough*>(component);
}
FMI2_ANSWER(fmi2OK, fmi2SetupExperiment, fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real)
FMI2_ANSWER(fmi2OK, fmi2EnterInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2ExitInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Terminate, fmi2Component)
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
    if (references[i] >= kRealCount) return fmi2Error;
    self(component).reals[references[i]] = values[i];
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
FMI2_NO_VALUES(Boolean)
FMI2_NO_VALUES(String)

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real, fmi2Real, fmi2Boolean) {
  Passthrough& p = self(component);
  fmi2Real x = p.reals[kU];
  for (fmi2Integer i = 0; i < p.work; ++i) x = 0.5 * x + p.reals[kU];
  p.reals[kY] = p.work == 0 ? p.reals[kU] : 0.5 * x;  // x converges to 2 u, so y converges to u
  p.reals[kSum] += p.reals[kU];
  return fmi2OK;
}

FMI2_NO_STATE
FMI2_NO_BYTES
FMI2_NO_DIRECTIONAL_DERIVATIVE
FMI2_NO_TIME_DERIVATIVES
FMI2_NO_PENDING_STEPS
FMI2_NO_REAL_STATUS
FMI2_NO_OTHER_STATUS
