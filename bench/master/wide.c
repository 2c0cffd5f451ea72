// SPDX-License-Identifier: Apache-2.0
// An FMU with COUNT inputs, outputs and parameters (-DCOUNT=...). y[i] is u[i] of the previous step; with -DDIRECT, it
// is the current u[i]. sizes.py compiles this file and writes the description.
#include "fmi2.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
  double values[3 * COUNT];  // inputs, then outputs, then parameters
} Instance;

FMI2_EXPORT const char* fmi2GetTypesPlatform(void) {
  return "default";
}

FMI2_EXPORT const char* fmi2GetVersion(void) {
  return "2.0";
}

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
  (void)c, (void)on, (void)n, (void)categories;
  return fmi2OK;
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions* callbacks, fmi2Boolean visible, fmi2Boolean on) {
  (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)on;
  return calloc(1, sizeof(Instance));
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) {
  free(c);
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  (void)c;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  (void)c;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
  (void)c;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component c) {
  memset(c, 0, sizeof(Instance));
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real values[]) {
  const Instance* const instance = c;
  for (size_t i = 0; i < n; ++i) values[i] = instance->values[vr[i]];
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real values[]) {
  Instance* const instance = c;
  for (size_t i = 0; i < n; ++i) {
    instance->values[vr[i]] = values[i];
#ifdef DIRECT
    if (vr[i] < COUNT) instance->values[COUNT + vr[i]] = values[i];
#endif
  }
  return fmi2OK;
}

#define NO_VALUES(Name, Type)                                                                                      \
  FMI2_EXPORT fmi2Status fmi2Get##Name(fmi2Component c, const fmi2ValueReference vr[], size_t n, Type values[]) {  \
    (void)c, (void)vr, (void)values;                                                                               \
    return n == 0 ? fmi2OK : fmi2Error;                                                                            \
  }                                                                                                                \
  FMI2_EXPORT fmi2Status fmi2Set##Name(fmi2Component c, const fmi2ValueReference vr[], size_t n, const Type v[]) { \
    (void)c, (void)vr, (void)v;                                                                                    \
    return n == 0 ? fmi2OK : fmi2Error;                                                                            \
  }
NO_VALUES(Integer, fmi2Integer)
NO_VALUES(Boolean, fmi2Boolean)
NO_VALUES(String, fmi2String)

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_set_state) {
  (void)time, (void)step, (void)no_set_state;
  Instance* const instance = c;
  memcpy(instance->values + COUNT, instance->values, COUNT * sizeof(double));
  return fmi2OK;
}
