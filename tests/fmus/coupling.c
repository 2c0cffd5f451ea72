// SPDX-License-Identifier: Apache-2.0
// A foreign FMU for tests of connections and steps: units, conversions, loops, derivatives of inputs, and steps that
// are pending, discarded or ended.
//
//   loop_out = a + b * loop_in + c * loop_in^2     (direct, also in initialisation mode)
//   ramp_out = t^2, with its derivatives 2 t and 2
//   ramp_area += h u + h^2/2 u' of ramp_in and its first derivative
//   mass_x: m x'' = -10 x - 10 (x - mass_u) with m = 1, exact for an input that is a polynomial of order 2 in a step;
//   gives x' and x''
//   behaviour nan_slope -> all derivatives of outputs are NaN
//   kelvin_out and so on repeat their inputs (direct)
//   behaviour: "" | callback | poll | never | late_discard  -> the step is fmi2Pending and takes pause wall seconds
//              stale   -> like poll, but calls stepFinished for the step before when a step begins
//              never   -> logs all the time
//              denied  -> like callback, but fmi2GetStatus always reports fmi2Pending
//              stubborn-> like never, and fmi2CancelStep returns fmi2Error
//              broken  -> like never, and fmi2GetStatus returns fmi2Error
//              short   -> steps longer than max_step stop at t + max_step with fmi2Discard
//              refuse  -> every step of any length is discarded
//   COUPLING_WITHOUT_CANCEL: the library lacks fmi2CancelStep
#include "fmi2.h"

#include "frame.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
  LOOP_IN,
  LOOP_OUT,
  A,
  B,
  C,
  RAMP_IN,
  RAMP_OUT,
  RAMP_AREA,
  MAX_STEP,
  PAUSE,
  CELSIUS,
  SPEED_KMH,
  ANGLE_DEG,
  CHARGE_MAH,
  KELVIN_IN,
  SPEED_IN,
  ANGLE_IN,
  CHARGE_IN,
  KELVIN_OUT,
  SPEED_OUT,
  ANGLE_OUT,
  CHARGE_OUT,
  BARE_IN,
  BARE_OUT,
  FURLONG,
  DIFFERENCE,
  TIME,
  MASS_U,
  MASS_X,
  MASS_V,
  REALS
};
enum { COUNT, LEVEL, COUNT_IN, STEPS, CANCELLED, LEVEL_IN, INTEGERS };
enum { FLAG, BOOLEANS };
enum { BEHAVIOUR, STRINGS };
enum { TEXT_SIZE = 64 };

typedef struct {
  double reals[REALS];
  int integers[INTEGERS];
  int booleans[BOOLEANS];
  char strings[STRINGS][TEXT_SIZE];
  double ramp_slope;
  double mass_u[2];  // derivatives of mass_u
  double mass_a;
} State;

typedef struct {
  State state;
  const fmi2CallbackFunctions* callbacks;
  double last_successful;
  double h;
  pthread_t thread;
  int running;
  atomic_int status;  // status of the step; fmi2Pending while the step continues
  atomic_int cancelled;
} Model;

static void compute(Model* m) {
  double* r = m->state.reals;
  r[LOOP_OUT] = r[A] + r[B] * r[LOOP_IN] + r[C] * r[LOOP_IN] * r[LOOP_IN];
  r[KELVIN_OUT] = r[KELVIN_IN];
  r[SPEED_OUT] = r[SPEED_IN];
  r[ANGLE_OUT] = r[ANGLE_IN];
  r[CHARGE_OUT] = r[CHARGE_IN];
  r[BARE_OUT] = r[BARE_IN];
}

static void join(Model* m) {
  if (m->running) pthread_join(m->thread, NULL);
  m->running = 0;
}

FMI2_VERSIONS

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions* callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  (void)name, (void)type, (void)guid, (void)resources, (void)visible, (void)logging;
  Model* m = calloc(1, sizeof *m);
  m->callbacks = callbacks;
  m->state.reals[MAX_STEP] = 1;
  return m;
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) {
  if (c == NULL) return;
  join(c);
  free(c);
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
  ((Model*)c)->state.reals[TIME] = start;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  compute(c);
  return fmi2OK;
}
FMI2_ANSWER(fmi2OK, fmi2ExitInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Terminate, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Reset, fmi2Component)

#define REALS_OF(c) (((Model*)(c))->state.reals)
#define INTEGERS_OF(c) (((Model*)(c))->state.integers)
#define BOOLEANS_OF(c) (((Model*)(c))->state.booleans)
FMI2_VALUES(Real, REALS_OF, REALS, compute)
FMI2_VALUES(Integer, INTEGERS_OF, INTEGERS, compute)
FMI2_VALUES(Boolean, BOOLEANS_OF, BOOLEANS, compute)

FMI2_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
  for (size_t i = 0; i < n; ++i) v[i] = ((Model*)c)->state.strings[r[i]];
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String v[]) {
  for (size_t i = 0; i < n; ++i) strncpy(((Model*)c)->state.strings[r[i]], v[i], TEXT_SIZE - 1);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                                   const fmi2Integer order[], const fmi2Real value[]) {
  for (size_t i = 0; i < n; ++i) {
    if (r[i] != RAMP_IN && r[i] != MASS_U) return fmi2Error;
    if (r[i] == MASS_U) ((Model*)c)->state.mass_u[order[i] - 1] = value[i];
    if (r[i] == RAMP_IN && order[i] == 1) ((Model*)c)->state.ramp_slope = value[i];
  }
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                                    const fmi2Integer order[], fmi2Real value[]) {
  const double t = ((Model*)c)->state.reals[TIME];
  for (size_t i = 0; i < n; ++i) {
    const State* s = &((Model*)c)->state;
    if (r[i] == RAMP_OUT) {
      value[i] = order[i] == 1 ? 2 * t : 2;
    } else if (r[i] == MASS_X) {
      value[i] = order[i] == 1 ? s->reals[MASS_V] : s->mass_a;
    } else {
      return fmi2Error;
    }
    if (strcmp(s->strings[BEHAVIOUR], "nan_slope") == 0) value[i] = NAN;
  }
  return fmi2OK;
}

static void move_mass(State* s, double h) {
  const double stiffness = 20, coupling = 10, w = sqrt(stiffness);
  const double* u = s->mass_u;
  const double c2 = coupling * u[1] / 2 / stiffness;
  const double c1 = coupling * u[0] / stiffness;
  const double c0 = (coupling * s->reals[MASS_U] - 2 * c2) / stiffness;
  const double p = s->reals[MASS_X] - c0, q = (s->reals[MASS_V] - c1) / w;
  s->reals[MASS_X] = c0 + c1 * h + c2 * h * h + p * cos(w * h) + q * sin(w * h);
  s->reals[MASS_V] = c1 + 2 * c2 * h + w * (q * cos(w * h) - p * sin(w * h));
  s->mass_a = coupling * (s->reals[MASS_U] + u[0] * h + u[1] * h * h / 2) - stiffness * s->reals[MASS_X];
}

static void advance(Model* m, double t, double h) {
  move_mass(&m->state, h);
  double* r = m->state.reals;
  r[RAMP_AREA] += h * r[RAMP_IN] + h * h / 2 * m->state.ramp_slope;
  r[TIME] = t + h;
  r[RAMP_OUT] = r[TIME] * r[TIME];
  m->state.integers[STEPS] += 1;
  m->last_successful = t + h;
}

static int is_endless(const char* behaviour) {
  return strcmp(behaviour, "never") == 0 || strcmp(behaviour, "stubborn") == 0 || strcmp(behaviour, "broken") == 0;
}

static void* later(void* argument) {
  Model* m = argument;
  const char* behaviour = m->state.strings[BEHAVIOUR];
  if (is_endless(behaviour)) {
    while (!m->cancelled) {
      m->callbacks->logger(m->callbacks->componentEnvironment, "", fmi2OK, "", "the step continues");
      usleep(1000);
    }
    return NULL;
  }
  usleep((unsigned)(m->state.reals[PAUSE] * 1e6));
  fmi2Status status = fmi2OK;
  if (strcmp(behaviour, "late_discard") == 0) {
    status = fmi2Discard;
  } else {
    advance(m, m->state.reals[TIME], m->h);
  }
  m->status = status;
  const int calls_back = strcmp(behaviour, "poll") != 0 && strcmp(behaviour, "stale") != 0;
  if (calls_back) m->callbacks->stepFinished(m->callbacks->componentEnvironment, status);
  return NULL;
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_set) {
  (void)no_set;
  Model* m = c;
  join(m);
  const char* behaviour = m->state.strings[BEHAVIOUR];
  m->last_successful = t;
  m->h = h;
  if (strcmp(behaviour, "refuse") == 0) return fmi2Discard;
  if (strcmp(behaviour, "short") == 0 && h > m->state.reals[MAX_STEP] * (1 + 1e-9)) {
    advance(m, t, m->state.reals[MAX_STEP]);
    return fmi2Discard;
  }
  if (behaviour[0] == 0 || strcmp(behaviour, "short") == 0 || strcmp(behaviour, "nan_slope") == 0) {
    advance(m, t, h);
    return fmi2OK;
  }
  m->state.reals[TIME] = t;
  if (strcmp(behaviour, "stale") == 0) m->callbacks->stepFinished(m->callbacks->componentEnvironment, fmi2OK);
  m->status = fmi2Pending;
  m->running = 1;
  pthread_create(&m->thread, NULL, later, m);
  return fmi2Pending;
}

#ifndef COUPLING_WITHOUT_CANCEL
FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component c) {
  Model* m = c;
  if (strcmp(m->state.strings[BEHAVIOUR], "stubborn") == 0) return fmi2Error;
  m->cancelled = 1;
  join(m);
  m->state.integers[CANCELLED] += 1;
  return fmi2OK;
}
#endif

FMI2_EXPORT fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status* value) {
  if (kind != fmi2DoStepStatus) return fmi2Discard;
  const char* behaviour = ((Model*)c)->state.strings[BEHAVIOUR];
  if (strcmp(behaviour, "broken") == 0) return fmi2Error;
  *value = strcmp(behaviour, "denied") == 0 ? fmi2Pending : (fmi2Status)((Model*)c)->status;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
  *value = ((Model*)c)->last_successful;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  if (*state == NULL) *state = malloc(sizeof(State));
  memcpy(*state, &((Model*)c)->state, sizeof(State));
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  memcpy(&((Model*)c)->state, state, sizeof(State));
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  (void)c;
  free(*state);
  *state = NULL;
  return fmi2OK;
}

FMI2_NO_BYTES
FMI2_NO_DIRECTIONAL_DERIVATIVE
FMI2_NO_OTHER_STATUS
