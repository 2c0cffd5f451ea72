// SPDX-License-Identifier: Apache-2.0
// Functions that all test FMUs share, for C and C++. Include the interface first: "fmi2.h" (independent of MEbots' own
// headers) or "mebots/fmi2/functions.hpp".
#pragma once

#ifdef __cplusplus
#define FMI2_DEFINE  // functions.hpp declares the functions with their visibility
#else
#define FMI2_DEFINE FMI2_EXPORT
#endif

/// Defines a function that returns `status` without effect.
#define FMI2_ANSWER(status, name, ...)       \
  FMI2_DEFINE fmi2Status name(__VA_ARGS__) { \
    return status;                           \
  }

#define FMI2_VERSIONS                              \
  FMI2_DEFINE const char* fmi2GetTypesPlatform() { \
    return "default";                              \
  }                                                \
  FMI2_DEFINE const char* fmi2GetVersion() {       \
    return "2.0";                                  \
  }                                                \
  FMI2_ANSWER(fmi2OK, fmi2SetDebugLogging, fmi2Component, fmi2Boolean, size_t, const fmi2String[])

// Defines functions that return an error. Some tools load a library only if it exports all functions of the standard,
// including functions that the FMU does not support.
#define FMI2_NO_STATE                                                   \
  FMI2_ANSWER(fmi2Error, fmi2GetFMUstate, fmi2Component, fmi2FMUstate*) \
  FMI2_ANSWER(fmi2Error, fmi2SetFMUstate, fmi2Component, fmi2FMUstate)  \
  FMI2_ANSWER(fmi2Error, fmi2FreeFMUstate, fmi2Component, fmi2FMUstate*)
#define FMI2_NO_BYTES                                                                            \
  FMI2_ANSWER(fmi2Error, fmi2SerializedFMUstateSize, fmi2Component, fmi2FMUstate, size_t*)       \
  FMI2_ANSWER(fmi2Error, fmi2SerializeFMUstate, fmi2Component, fmi2FMUstate, fmi2Byte[], size_t) \
  FMI2_ANSWER(fmi2Error, fmi2DeSerializeFMUstate, fmi2Component, const fmi2Byte[], size_t, fmi2FMUstate*)
#define FMI2_NO_DIRECTIONAL_DERIVATIVE                                                                    \
  FMI2_ANSWER(fmi2Error, fmi2GetDirectionalDerivative, fmi2Component, const fmi2ValueReference[], size_t, \
              const fmi2ValueReference[], size_t, const fmi2Real[], fmi2Real[])
#define FMI2_NO_TIME_DERIVATIVES                                                                          \
  FMI2_ANSWER(fmi2Error, fmi2SetRealInputDerivatives, fmi2Component, const fmi2ValueReference[], size_t,  \
              const fmi2Integer[], const fmi2Real[])                                                      \
  FMI2_ANSWER(fmi2Error, fmi2GetRealOutputDerivatives, fmi2Component, const fmi2ValueReference[], size_t, \
              const fmi2Integer[], fmi2Real[])
#define FMI2_NO_PENDING_STEPS                           \
  FMI2_ANSWER(fmi2Error, fmi2CancelStep, fmi2Component) \
  FMI2_ANSWER(fmi2Discard, fmi2GetStatus, fmi2Component, fmi2StatusKind, fmi2Status*)
#define FMI2_NO_REAL_STATUS FMI2_ANSWER(fmi2Discard, fmi2GetRealStatus, fmi2Component, fmi2StatusKind, fmi2Real*)
#define FMI2_NO_OTHER_STATUS                                                                  \
  FMI2_ANSWER(fmi2Discard, fmi2GetIntegerStatus, fmi2Component, fmi2StatusKind, fmi2Integer*) \
  FMI2_ANSWER(fmi2Discard, fmi2GetBooleanStatus, fmi2Component, fmi2StatusKind, fmi2Boolean*) \
  FMI2_ANSWER(fmi2Discard, fmi2GetStringStatus, fmi2Component, fmi2StatusKind, fmi2String*)
#define FMI2_NO_VALUES(TYPE)                                                                                          \
  FMI2_DEFINE fmi2Status fmi2Get##TYPE(fmi2Component, const fmi2ValueReference[], size_t count, fmi2##TYPE[]) {       \
    return count == 0 ? fmi2OK : fmi2Error;                                                                           \
  }                                                                                                                   \
  FMI2_DEFINE fmi2Status fmi2Set##TYPE(fmi2Component, const fmi2ValueReference[], size_t count, const fmi2##TYPE[]) { \
    return count == 0 ? fmi2OK : fmi2Error;                                                                           \
  }

/// Defines the functions that get and set the variables of one type. The variables are the array FIELD(component) with
/// NUMBER values. The functions call CHANGED(component) after a change.
#define FMI2_VALUES(TYPE, FIELD, NUMBER, CHANGED)                                                                 \
  FMI2_DEFINE fmi2Status fmi2Get##TYPE(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##TYPE v[]) { \
    for (size_t i = 0; i < n; ++i) {                                                                              \
      if (r[i] >= (NUMBER)) return fmi2Error;                                                                     \
      v[i] = FIELD(c)[r[i]];                                                                                      \
    }                                                                                                             \
    return fmi2OK;                                                                                                \
  }                                                                                                               \
  FMI2_DEFINE fmi2Status fmi2Set##TYPE(fmi2Component c, const fmi2ValueReference r[], size_t n,                   \
                                       const fmi2##TYPE v[]) {                                                    \
    for (size_t i = 0; i < n; ++i) {                                                                              \
      if (r[i] >= (NUMBER)) return fmi2Error;                                                                     \
      FIELD(c)[r[i]] = v[i];                                                                                      \
    }                                                                                                             \
    CHANGED(c);                                                                                                   \
    return fmi2OK;                                                                                                \
  }
