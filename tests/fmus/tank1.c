// SPDX-License-Identifier: Apache-2.0
// A foreign FMU of FMI 1.0 for co-simulation: a tank, with aliases and negated aliases of each type.
//
//   rate = inflow / area, level' = rate, from level = initial_level when fmiInitializeSlave is called
//   drain = -rate, unsteps = -steps, and not_full is the opposite of full: negated aliases
//   offset_seen is the number that the FMU was given for `offset`, whose negated alias is minus_offset
//   start, stop and has_stop are the arguments of fmiInitializeSlave, location that of fmiInstantiateSlave
//   behaviour: "discard" ends at 0.5 s, "pending" finishes its steps later, "fatal" fails at 0.5 s, "wordy" logs,
//   "hang" sleeps, "callback" reports the end of its steps from a thread, and so does "unknown_callback", but with an
//   unknown component
//   TANK1_WITHOUT_STATUS: the library lacks fmiGetStatus and fmiCancelStep
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING };
enum { INFLOW, AREA, LEVEL, RATE, INITIAL_LEVEL, START, STOP, REALS };
enum { STEPS, OFFSET, HAS_STOP, OFFSET_SEEN, INTEGERS };
enum { FULL, BOOLEANS };
enum { BEHAVIOUR, LOCATION, STRINGS };

typedef void (*Logger)(void* component, const char* instance, int status, const char* category, const char* text, ...);

typedef struct {
  Logger logger;
  void* (*allocate)(size_t count, size_t size);
  void (*release)(void* memory);
  void (*step_finished)(void* component, int status);
} Callbacks;

typedef struct {
  double reals[REALS];
  int integers[INTEGERS];
  char booleans[BOOLEANS];
  char* strings[STRINGS];
  char* name;
  Callbacks callbacks;
  int asked;  // number of status queries for a pending step
  pthread_t thread;
  int running;
} Tank;

static char* copy(const char* text) {
  char* const result = malloc(strlen(text) + 1);
  strcpy(result, text);
  return result;
}

static int behaves(const Tank* m, const char* word) {
  return strcmp(m->strings[BEHAVIOUR], word) == 0;
}

static void* finish_later(void* argument) {
  Tank* m = argument;
  usleep(1000);
  m->callbacks.step_finished(behaves(m, "callback") ? m : NULL, OK);
  return NULL;
}

static void join(Tank* m) {
  if (m->running) pthread_join(m->thread, NULL);
  m->running = 0;
}

static void compute(Tank* m) {
  m->reals[RATE] = m->reals[INFLOW] / m->reals[AREA];
  m->booleans[FULL] = m->reals[LEVEL] >= 1;
  m->integers[OFFSET_SEEN] = m->integers[OFFSET];
}

EXPORT const char* tank1_fmiGetTypesPlatform(void) {
  return "standard32";
}
EXPORT const char* tank1_fmiGetVersion(void) {
  return "1.0";
}

EXPORT void* tank1_fmiInstantiateSlave(const char* name, const char* guid, const char* location, const char* mime_type,
                                       double timeout, char visible, char interactive, Callbacks callbacks,
                                       char logging) {
  (void)timeout, (void)visible, (void)interactive, (void)logging;
  if (strcmp(guid, "{tank}") != 0 || strcmp(mime_type, "application/x-fmu-sharedlibrary") != 0) return NULL;
  Tank* m = callbacks.allocate(1, sizeof *m);
  m->reals[INFLOW] = 1;
  m->reals[AREA] = 2;
  m->reals[INITIAL_LEVEL] = 0.25;
  m->strings[BEHAVIOUR] = copy("plain");
  m->strings[LOCATION] = copy(location);
  m->name = copy(name);
  m->callbacks = callbacks;
  return m;
}

EXPORT void tank1_fmiFreeSlaveInstance(void* instance) {
  Tank* m = instance;
  join(m);
  free(m->strings[BEHAVIOUR]);
  free(m->strings[LOCATION]);
  free(m->name);
  m->callbacks.release(m);
}

EXPORT int tank1_fmiSetDebugLogging(void* instance, char logging) {
  (void)instance, (void)logging;
  return OK;
}

EXPORT int tank1_fmiInitializeSlave(void* instance, double start, char has_stop, double stop) {
  Tank* m = instance;
  m->reals[LEVEL] = m->reals[INITIAL_LEVEL];
  m->reals[START] = start;
  m->reals[STOP] = stop;
  m->integers[HAS_STOP] = has_stop;
  compute(m);
  if (behaves(m, "wordy"))
    m->callbacks.logger(m, m->name, WARNING, "tank", "variable #r%d# starts at %g", LEVEL, m->reals[LEVEL]);
  return OK;
}

EXPORT int tank1_fmiTerminateSlave(void* instance) {
  (void)instance;
  return OK;
}
EXPORT int tank1_fmiResetSlave(void* instance) {
  (void)instance;
  return ERROR;
}

EXPORT int tank1_fmiDoStep(void* instance, double time, double step, char new_step) {
  Tank* m = instance;
  join(m);
  if (!new_step) return ERROR;
  if (time + step / 2 > 0.5 && behaves(m, "discard")) return DISCARD;
  if (time + step / 2 > 0.5 && behaves(m, "fatal")) return FATAL;
  if (behaves(m, "hang")) sleep(60);
  m->reals[LEVEL] += step * m->reals[INFLOW] / m->reals[AREA];
  ++m->integers[STEPS];
  compute(m);
  m->asked = 0;
  if (behaves(m, "callback") || behaves(m, "unknown_callback")) {
    m->running = 1;
    pthread_create(&m->thread, NULL, finish_later, m);
    return PENDING;
  }
  return behaves(m, "pending") ? PENDING : OK;
}

#ifndef TANK1_WITHOUT_STATUS
EXPORT int tank1_fmiCancelStep(void* instance) {
  (void)instance;
  return OK;
}
EXPORT int tank1_fmiGetStatus(void* instance, int kind, int* value) {
  (void)kind;
  *value = ++((Tank*)instance)->asked < 3 ? PENDING : OK;
  return OK;
}
#endif
EXPORT int tank1_fmiGetRealStatus(void* instance, int kind, double* value) {
  (void)instance, (void)kind;
  *value = 0.5;
  return OK;
}
EXPORT int tank1_fmiSetRealInputDerivatives(void* instance, const unsigned* references, size_t count, const int* orders,
                                            const double* values) {
  (void)instance, (void)references, (void)count, (void)orders, (void)values;
  return ERROR;
}
EXPORT int tank1_fmiGetRealOutputDerivatives(void* instance, const unsigned* references, size_t count,
                                             const int* orders, double* values) {
  (void)instance, (void)references, (void)count, (void)orders, (void)values;
  return ERROR;
}

#define GET(Name, Type, array)                                                                             \
  EXPORT int tank1_fmiGet##Name(void* instance, const unsigned* references, size_t count, Type values[]) { \
    for (size_t i = 0; i < count; ++i) values[i] = ((Tank*)instance)->array[references[i]];                \
    return OK;                                                                                             \
  }
#define SET(Name, Type, array)                                                                                   \
  EXPORT int tank1_fmiSet##Name(void* instance, const unsigned* references, size_t count, const Type values[]) { \
    for (size_t i = 0; i < count; ++i) ((Tank*)instance)->array[references[i]] = values[i];                      \
    return OK;                                                                                                   \
  }
GET(Real, double, reals)
SET(Real, double, reals)
GET(Integer, int, integers)
SET(Integer, int, integers)
GET(Boolean, char, booleans)
SET(Boolean, char, booleans)
GET(String, const char*, strings)

EXPORT int tank1_fmiSetString(void* instance, const unsigned* references, size_t count, const char* const values[]) {
  Tank* m = instance;
  for (size_t i = 0; i < count; ++i) {
    free(m->strings[references[i]]);
    m->strings[references[i]] = copy(values[i]);
  }
  return OK;
}
