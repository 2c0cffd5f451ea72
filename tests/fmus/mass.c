// SPDX-License-Identifier: Apache-2.0
// A foreign FMU for model exchange: a mass on a spring. A second spring, the grip, connects it to another mass.
//
//   x' = v,   v' = -stiffness x + force - grip (x - other_x)       (mass 1)
//   pull = grip (x - other_x), the force on the other mass
//
// A state event reverses the velocity at `wall`, and counts `hits`. The hit with the number `last_hit` ends the
// simulation. A time event adds `kick` to the velocity at `kick_time`. The discrete input `brake` stops the mass. After
// `nan_time`, the derivative of v is not a number. Four GUIDs select a fault. With "{mass:nan}", the derivative is not
// a number. With "{mass:endless}", events do not end. With "{mass:forgets}", a restored state lacks the speed. With
// "{mass:kicked}", a kick of 1 occurs at 0.15 s. `calls` counts evaluations. If `impure` is true, a derivative depends
// on this number.
#include "fmi2.h"

#include "frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FORCE, OTHER_X, X, V, DER_X, DER_V, PULL, STIFFNESS, GRIP, WALL, KICK, KICK_TIME, NAN_TIME, REALS };
enum { HITS, LAST_HIT, CALLS, INTEGERS };
enum { BRAKE, STOPPED, IMPURE, BOOLEANS };

typedef struct {
  double time;
  double reals[REALS];
  int integers[INTEGERS];
  int booleans[BOOLEANS];
  int kicked;
  int endless;
  int forgets;
} Model;

static void compute(Model* m) {
  double* r = m->reals;
  r[PULL] = r[GRIP] * (r[X] - r[OTHER_X]);
  r[DER_X] = m->booleans[STOPPED] ? 0 : r[V];
  r[DER_V] = m->booleans[STOPPED] ? 0 : -r[STIFFNESS] * r[X] + r[FORCE] - r[PULL];
  if (m->booleans[IMPURE]) r[DER_V] += 1e-12 * m->integers[CALLS];
  if (m->time > r[NAN_TIME]) r[DER_V] = NAN;
}

FMI2_VERSIONS

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions* callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  (void)name, (void)resources, (void)callbacks, (void)visible, (void)logging;
  if (type != fmi2ModelExchange) return NULL;
  Model* m = calloc(1, sizeof(Model));
  m->reals[STIFFNESS] = 1;
  m->reals[WALL] = m->reals[KICK_TIME] = m->reals[NAN_TIME] = 1e9;
  m->integers[LAST_HIT] = -1;
  if (strcmp(guid, "{mass:nan}") == 0) m->reals[NAN_TIME] = -1;
  if (strcmp(guid, "{mass:kicked}") == 0) {
    m->reals[KICK] = 1;
    m->reals[KICK_TIME] = 0.15;
  }
  m->endless = strcmp(guid, "{mass:endless}") == 0;
  m->forgets = strcmp(guid, "{mass:forgets}") == 0;
  return m;
}
FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) {
  free(c);
}

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start,
                                           fmi2Boolean stops, fmi2Real stop) {
  (void)tolerant, (void)tolerance, (void)stops, (void)stop;
  ((Model*)c)->time = start;
  return fmi2OK;
}
FMI2_ANSWER(fmi2OK, fmi2EnterInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2ExitInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Terminate, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Reset, fmi2Component)

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[]) {
  compute(c);
  for (size_t i = 0; i < n; ++i) {
    if (r[i] >= REALS) return fmi2Error;
    v[i] = ((Model*)c)->reals[r[i]];
  }
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real v[]) {
  for (size_t i = 0; i < n; ++i) {
    if (r[i] >= REALS) return fmi2Error;
    ((Model*)c)->reals[r[i]] = v[i];
  }
  return fmi2OK;
}
#define INTEGERS_OF(c) (((Model*)(c))->integers)
#define BOOLEANS_OF(c) (((Model*)(c))->booleans)
FMI2_VALUES(Integer, INTEGERS_OF, INTEGERS, compute)
FMI2_VALUES(Boolean, BOOLEANS_OF, BOOLEANS, compute)
FMI2_NO_VALUES(String)

FMI2_EXPORT fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
  ((Model*)c)->time = time;
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n) {
  if (n != 2) return fmi2Error;
  memcpy(x, &((Model*)c)->reals[X], 2 * sizeof(double));
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n) {
  if (n != 2) return fmi2Error;
  memcpy(&((Model*)c)->reals[X], x, 2 * sizeof(double));
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real dx[], size_t n) {
  if (n != 2) return fmi2Error;
  Model* m = c;
  ++m->integers[CALLS];
  compute(m);
  memcpy(dx, &m->reals[DER_X], 2 * sizeof(double));
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real z[], size_t n) {
  if (n != 1) return fmi2Error;
  z[0] = ((Model*)c)->reals[WALL] - ((Model*)c)->reals[X];
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominals[], size_t n) {
  (void)c;
  for (size_t i = 0; i < n; ++i) nominals[i] = 1;
  return fmi2OK;
}
FMI2_ANSWER(fmi2OK, fmi2EnterEventMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2EnterContinuousTimeMode, fmi2Component)
FMI2_EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set, fmi2Boolean* enter_event_mode,
                                                   fmi2Boolean* terminate) {
  (void)c, (void)no_set;
  *enter_event_mode = *terminate = 0;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo* info) {
  Model* m = c;
  double* r = m->reals;
  memset(info, 0, sizeof *info);
  m->booleans[STOPPED] = m->booleans[BRAKE];
  if (m->booleans[STOPPED]) r[V] = 0;
  if (r[X] >= r[WALL] && r[V] > 0) {
    r[V] = -r[V];
    ++m->integers[HITS];
    info->valuesOfContinuousStatesChanged = 1;
  }
  if (!m->kicked && m->time >= r[KICK_TIME]) {
    r[V] += r[KICK];
    m->kicked = 1;
    info->valuesOfContinuousStatesChanged = 1;
  }
  info->newDiscreteStatesNeeded = m->endless;
  info->terminateSimulation = m->integers[HITS] == m->integers[LAST_HIT];
  info->nextEventTimeDefined = !m->kicked;
  info->nextEventTime = r[KICK_TIME];
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                                    size_t unknowns, const fmi2ValueReference known[], size_t knowns,
                                                    const fmi2Real seed[], fmi2Real change[]) {
  const Model* m = c;
  double d[REALS] = {0};
  for (size_t i = 0; i < knowns; ++i) d[known[i]] = seed[i];
  d[PULL] = m->reals[GRIP] * (d[X] - d[OTHER_X]);
  d[DER_X] = m->booleans[STOPPED] ? 0 : d[V];
  d[DER_V] = m->booleans[STOPPED] ? 0 : -m->reals[STIFFNESS] * d[X] + d[FORCE] - d[PULL];
  for (size_t i = 0; i < unknowns; ++i) change[i] = d[unknown[i]];
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  if (*state == NULL) *state = malloc(sizeof(Model));
  memcpy(*state, c, sizeof(Model));
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  memcpy(c, state, sizeof(Model));
  if (((Model*)c)->forgets) ((Model*)c)->reals[V] = 7;
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  (void)c;
  free(*state);
  *state = NULL;
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t* size) {
  (void)c, (void)state;
  *size = sizeof(Model);
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  (void)c;
  if (size != sizeof(Model)) return fmi2Error;
  memcpy(bytes, state, size);
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate* state) {
  (void)c;
  if (size != sizeof(Model)) return fmi2Error;
  *state = malloc(size);
  memcpy(*state, bytes, size);
  return fmi2OK;
}
