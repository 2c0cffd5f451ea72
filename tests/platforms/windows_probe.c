// SPDX-License-Identifier: Apache-2.0
// An FMU for Linux and Windows, for windows_fmu_test.py. It uses no code of MEbots.
//
//   y = y + h * (u + 0.1), text = name + "|" + count, where count is the number of steps
//   fault names the fault that occurs in the step that reaches 0.5 s
#include "fmi2.h"

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
#endif

enum { TEXT_SIZE = 200 };

typedef struct {
  fmi2CallbackFunctions callbacks;
  char instance[TEXT_SIZE];
  double reals[2];  // u, y
  int count;
  char strings[4][TEXT_SIZE];  // name, fault, text, first line of resources/line.txt
} Probe;

static Probe* of(fmi2Component component) {
  return component;
}

static void say(Probe* p, fmi2Status status, const char* format, double number, const char* text) {
  p->callbacks.logger(p->callbacks.componentEnvironment, p->instance, status, "console", format, number, text);
}

/// Reads the first line of line.txt in a folder. The folder's URI is percent-encoded, as in a call of fmi2Instantiate.
static void read_line(const char* uri, char* line) {
  char path[2 * TEXT_SIZE] = "";
  size_t length = 0;
#ifdef _WIN32
  uri += strlen("file:///");
#else
  uri += strlen("file://");
#endif
  for (; *uri != 0 && length + 1 < sizeof path; ++uri) {
    unsigned code = (unsigned char)*uri;
    if (*uri == '%' && sscanf(uri + 1, "%2x", &code) == 1) uri += 2;
    path[length++] = (char)code;
  }
  snprintf(path + length, sizeof path - length, "/line.txt");
#ifdef _WIN32
  wchar_t wide[2 * TEXT_SIZE];
  MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, 2 * TEXT_SIZE);
  FILE* file = _wfopen(wide, L"r");
#else
  FILE* file = fopen(path, "r");
#endif
  if (file == NULL || fgets(line, TEXT_SIZE, file) == NULL) strcpy(line, "no line");
  if (file != NULL) fclose(file);
}

static int deeper(int depth) {
  volatile char frame[4096];
  frame[depth % 4096] = (char)depth;
  return deeper(depth + 1) + frame[(depth + 1) % 4096];
}

static void fail(Probe* p) {
  const char* fault = p->strings[1];
  volatile int zero = 0;
  if (strcmp(fault, "crash") == 0) *(volatile int*)0x1230 = 1;
  if (strcmp(fault, "divide") == 0) p->count = p->count / zero;
  if (strcmp(fault, "stack") == 0) p->count = deeper(0);
  if (strcmp(fault, "exit") == 0) exit(5);
  if (strcmp(fault, "abort") == 0) abort();
  if (strcmp(fault, "print") == 0) printf("printed by the FMU\n");
  while (strcmp(fault, "hang") == 0) {
  }
  while (strcmp(fault, "memory") == 0) memset(malloc(16 << 20), 1, 16 << 20);
#ifdef _WIN32
  if (strcmp(fault, "locale") == 0) {
    setlocale(LC_ALL, "German_Germany.1252");
    fprintf(stderr, "locale: %g\n", 1.5);
  }
  if (strcmp(fault, "raise") == 0) RaiseException(0xe06d7363, 0, 0, NULL);
#endif
}

FMI2_EXPORT const char* fmi2GetTypesPlatform(void) {
  return "default";
}
FMI2_EXPORT const char* fmi2GetVersion(void) {
  return "2.0";
}
FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions* callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  (void)type, (void)visible, (void)logging;
  Probe* p = callbacks->allocateMemory(1, sizeof *p);
  p->callbacks = *callbacks;
  strncpy(p->instance, name, TEXT_SIZE - 1);
  read_line(resources, p->strings[3]);
  say(p, fmi2OK, "%g for %s", 1.5, guid);
  return p;
}
FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) {
  of(c)->callbacks.freeMemory(c);
}
FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, double tolerance, double start,
                                           fmi2Boolean has_stop, double stop) {
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
FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, double time, double length, fmi2Boolean keep) {
  (void)keep;
  Probe* p = of(c);
  if (time + length > 0.5 - 1e-9) fail(p);
  p->reals[1] += length * (p->reals[0] + 0.1);
  ++p->count;
  if (p->count % 4 == 0) say(p, fmi2Warning, "at %g: %s", time, "caf\xc3\xa9");
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, double v[]) {
  for (size_t i = 0; i < n; ++i) v[i] = of(c)->reals[r[i]];
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const double v[]) {
  for (size_t i = 0; i < n; ++i) of(c)->reals[r[i]] = v[i];
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, int v[]) {
  for (size_t i = 0; i < n; ++i) v[i] = r[i] == 0 ? of(c)->count : 0;
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, const int v[]) {
  (void)c, (void)r, (void)n, (void)v;
  return fmi2Error;
}
FMI2_EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, int v[]) {
  (void)c, (void)r, (void)n, (void)v;
  return fmi2Error;
}
FMI2_EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, const int v[]) {
  (void)c, (void)r, (void)n, (void)v;
  return fmi2Error;
}
FMI2_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
  Probe* p = of(c);
  snprintf(p->strings[2], TEXT_SIZE, "%.100s|%d", p->strings[0], p->count);
  for (size_t i = 0; i < n; ++i) v[i] = p->strings[r[i]];
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String v[]) {
  for (size_t i = 0; i < n; ++i) strncpy(of(c)->strings[r[i]], v[i], TEXT_SIZE - 1);
  return fmi2OK;
}
