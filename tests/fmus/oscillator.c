// SPDX-License-Identifier: Apache-2.0
// A foreign FMU: half of an oscillator. Force and velocity connect it to the other half.
//
//   m x'' = -k (x - rest) + force - pull,   y' = other_velocity       (m = 1, k = 10 unless parameters say otherwise)
//   pull = grip (x - y) + damping (x' - other_velocity), the force on the mass at y
//
// With grip = 0, the FMU is a mass on a spring. Its input is a force, its output is the velocity. With grip > 0, it
// also has a spring to another mass, whose velocity is an input. In a step, an input with the value v and the
// derivative d is v + d tau at the time tau after its start. The classical Runge-Kutta method with 64 steps makes
// internal errors negligible compared with those of the coupling.
//
//   energy = m v^2/2 + k x^2/2 + grip (x - y)^2/2
//
// If damping and rest are 0, only the work of force and pull changes it. Therefore the sum of both halves' energies
// changes only by the energy that the coupling adds. From `rest_until` on, rest is 0. No other FMU can predict this
// jump.
#include "fmi2.h"

#include "frame.h"

#include <stdlib.h>

enum { FORCE, OTHER_VELOCITY, X, VELOCITY, Y, PULL, GRIP, ENERGY, MASS, STIFFNESS, DAMPING, REST, REST_UNTIL, REALS };
enum { PARTS = 64 };

typedef struct {
  double reals[REALS];
  double slopes[2];  // slopes of FORCE and OTHER_VELOCITY
  double acceleration, pull_rate;
} Model;

typedef struct {
  double x, v, y;
} Body;

static Body rate(const Model* m, double rest, Body s, double tau) {
  const double* r = m->reals;
  const double force = r[FORCE] + m->slopes[FORCE] * tau;
  const double velocity = r[OTHER_VELOCITY] + m->slopes[OTHER_VELOCITY] * tau;
  const double pull = r[GRIP] * (s.x - s.y) + r[DAMPING] * (s.v - velocity);
  const Body result = {s.v, (force - r[STIFFNESS] * (s.x - rest) - pull) / r[MASS], velocity};
  return result;
}

static Body moved(Body s, Body rate, double h) {
  const Body result = {s.x + h * rate.x, s.v + h * rate.v, s.y + h * rate.y};
  return result;
}

static void compute(Model* m) {
  double* r = m->reals;
  r[PULL] = r[GRIP] * (r[X] - r[Y]) + r[DAMPING] * (r[VELOCITY] - r[OTHER_VELOCITY]);
  r[ENERGY] =
      (r[MASS] * r[VELOCITY] * r[VELOCITY] + r[STIFFNESS] * r[X] * r[X] + r[GRIP] * (r[X] - r[Y]) * (r[X] - r[Y])) / 2;
}

/// Returns the body's state at tau + length, integrated from the state `s` at tau.
static Body integrated(const Model* m, double rest, Body s, double tau, double length) {
  const double h = length / PARTS;
  for (int part = 0; part < PARTS; ++part) {
    const double from = tau + part * h;
    const Body k1 = rate(m, rest, s, from);
    const Body k2 = rate(m, rest, moved(s, k1, h / 2), from + h / 2);
    const Body k3 = rate(m, rest, moved(s, k2, h / 2), from + h / 2);
    const Body k4 = rate(m, rest, moved(s, k3, h), from + h);
    s = moved(moved(moved(moved(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
  }
  return s;
}

static void advance(Model* m, double time, double length) {
  double* r = m->reals;
  const double left = r[REST_UNTIL] - time;
  const double before = left <= 0 ? 0 : left < length ? left : length;
  Body s = {r[X], r[VELOCITY], r[Y]};
  if (before > 0) s = integrated(m, r[REST], s, 0, before);
  if (before < length) s = integrated(m, 0, s, before, length - before);
  const Body last = rate(m, before < length ? 0 : r[REST], s, length);
  r[X] = s.x;
  r[VELOCITY] = s.v;
  r[Y] = s.y;
  m->acceleration = last.v;
  m->pull_rate = r[GRIP] * (last.x - last.y) + r[DAMPING] * (last.v - m->slopes[OTHER_VELOCITY]);
  compute(m);
}

FMI2_VERSIONS

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions* callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
  Model* m = calloc(1, sizeof(Model));
  if (m == NULL) return NULL;
  m->reals[MASS] = 1;
  m->reals[STIFFNESS] = 10;
  return m;
}
FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) {
  free(c);
}

FMI2_ANSWER(fmi2OK, fmi2SetupExperiment, fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real)
FMI2_ANSWER(fmi2OK, fmi2EnterInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2ExitInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Terminate, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Reset, fmi2Component)

#define REALS_OF(c) (((Model*)(c))->reals)
FMI2_VALUES(Real, REALS_OF, REALS, compute)
FMI2_NO_VALUES(Integer)
FMI2_NO_VALUES(Boolean)
FMI2_NO_VALUES(String)

FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                                   const fmi2Integer order[], const fmi2Real value[]) {
  for (size_t i = 0; i < n; ++i) {
    if (r[i] > OTHER_VELOCITY || order[i] != 1) return fmi2Error;
    ((Model*)c)->slopes[r[i]] = value[i];
  }
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                                    const fmi2Integer order[], fmi2Real value[]) {
  const Model* m = c;
  for (size_t i = 0; i < n; ++i) {
    if ((r[i] != VELOCITY && r[i] != PULL) || order[i] != 1) return fmi2Error;
    value[i] = r[i] == VELOCITY ? m->acceleration : m->pull_rate;
  }
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_set) {
  (void)no_set;
  advance(c, t, h);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  if (*state == NULL) *state = malloc(sizeof(Model));
  *(Model*)*state = *(Model*)c;
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  *(Model*)c = *(Model*)state;
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
FMI2_NO_PENDING_STEPS
FMI2_NO_REAL_STATUS
FMI2_NO_OTHER_STATUS
