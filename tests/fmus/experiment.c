// SPDX-License-Identifier: Apache-2.0
// A foreign FMU whose values depend on the arguments of fmi2SetupExperiment. For true Booleans, it uses another number
// than 1. Its text is not UTF-8.
//
//   x' = -x, by explicit Euler in internal steps of `tolerance` (0.125 if none is passed)
//   clock = the time that the FMU has reached: the end of the step, or the stop time if one is passed. FMUs of some
//   OpenModelica versions do the same: they compute up to the stop time in their first step.
//   start, stop, tolerance, has_stop and has_tolerance are the arguments; 0 for what is not passed
//   flag_out = true as the number -1, flag_seen = the number that flag_in was set to
//   text = "caf" and the byte 0xE9, which is Latin-1
#include "fmi2.h"

#include "frame.h"

#include <stdlib.h>

enum { X, CLOCK, START, STOP, TOLERANCE, REALS };
enum { HAS_STOP, HAS_TOLERANCE, FLAG_SEEN, INTEGERS };
enum { FLAG_IN, FLAG_OUT, BOOLEANS };

typedef struct {
  double reals[REALS];
  int integers[INTEGERS];
  int booleans[BOOLEANS];
} Model;

static void compute(Model* m) {
  m->integers[FLAG_SEEN] = m->booleans[FLAG_IN];
}

FMI2_VERSIONS

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions* callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
  Model* m = calloc(1, sizeof *m);
  m->reals[X] = 1;
  m->booleans[FLAG_OUT] = -1;
  return m;
}
FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) {
  free(c);
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  Model* m = c;
  m->reals[START] = start;
  m->reals[CLOCK] = start;
  m->reals[STOP] = has_stop ? stop : 0;
  m->reals[TOLERANCE] = has_tolerance ? tolerance : 0;
  m->integers[HAS_STOP] = has_stop;
  m->integers[HAS_TOLERANCE] = has_tolerance;
  return fmi2OK;
}
FMI2_ANSWER(fmi2OK, fmi2EnterInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2ExitInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Terminate, fmi2Component)

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component c) {
  const Model fresh = {.reals = {[X] = 1}, .booleans = {[FLAG_OUT] = -1}};
  *(Model*)c = fresh;
  return fmi2OK;
}

#define REALS_OF(c) (((Model*)(c))->reals)
#define INTEGERS_OF(c) (((Model*)(c))->integers)
#define BOOLEANS_OF(c) (((Model*)(c))->booleans)
FMI2_VALUES(Real, REALS_OF, REALS, compute)
FMI2_VALUES(Integer, INTEGERS_OF, INTEGERS, compute)
FMI2_VALUES(Boolean, BOOLEANS_OF, BOOLEANS, compute)

FMI2_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
  (void)c;
  for (size_t i = 0; i < n; ++i) {
    if (r[i] != 0) return fmi2Error;
    v[i] = "caf\xe9";
  }
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String v[]) {
  (void)c, (void)r, (void)v;
  return n == 0 ? fmi2OK : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_set) {
  (void)no_set;
  Model* m = c;
  const double end = m->integers[HAS_STOP] ? m->reals[STOP] : t + h;
  const double length = m->integers[HAS_TOLERANCE] ? m->reals[TOLERANCE] : 0.125;
  const int parts = (int)((end - m->reals[CLOCK]) / length + 0.5);
  for (int part = 0; part < parts; ++part) m->reals[X] -= length * m->reals[X];
  m->reals[CLOCK] = end;
  return fmi2OK;
}

FMI2_NO_STATE
FMI2_NO_BYTES
FMI2_NO_DIRECTIONAL_DERIVATIVE
FMI2_NO_TIME_DERIVATIVES
FMI2_NO_PENDING_STEPS
FMI2_NO_REAL_STATUS
FMI2_NO_OTHER_STATUS
