// SPDX-License-Identifier: Apache-2.0
// FMUs that store data outside of their instances. LEFTOVER_KIND selects the place. In every step, `sum` increases by
// gain times the data, so the second run in a process has another sum than the first run.
#include "mebots/fmi2/functions.hpp"

#include "count.h"
#include "frame.h"

#include <cstdlib>
#include <cstring>
#include <map>
#include <new>
#include <string>

namespace {

enum Reference : fmi2ValueReference { kGain, kSum, kRealCount };

struct Instance {
  fmi2Real reals[kRealCount] = {1, 0};
};

fmi2Real* reals_of(fmi2Component component) {
  return static_cast<Instance*>(component)->reals;
}
void changed(fmi2Component) {}

// Each branch stores data in another place outside of the instances. LEFTOVER_NOTHING stores none.
#if defined(LEFTOVER_NOTHING)
void begin_instance() {}
double next() {
  return 1;
}
#elif defined(LEFTOVER_STATIC_VARIABLE)
int steps;
void begin_instance() {}
double next() {
  return ++steps;
}
#elif defined(LEFTOVER_FIRST_INSTANCE)
// All instances after the first instance of a process get the same data. Therefore only the first instance has other
// results.
bool is_first = true;
double kept = 1;
void begin_instance() {
  kept = is_first ? 1 : 2;
  is_first = false;
}
double next() {
  return kept;
}
#elif defined(LEFTOVER_STATIC_OBJECT)
// The bytes of the object do not change, but the memory to which it points changes.
std::map<std::string, int> counts{{"steps", 0}};
void begin_instance() {}
double next() {
  return ++counts["steps"];
}
#elif defined(LEFTOVER_THREAD_LOCAL)
thread_local int steps;
void begin_instance() {}
double next() {
  return ++steps;
}
#elif defined(LEFTOVER_LIBRARY)
void begin_instance() {}
double next() {
  return leftover_count();
}
#elif defined(LEFTOVER_RAND)
void begin_instance() {}
double next() {
  return std::rand() % 1000;  // NOLINT(cert-msc50-cpp): that is the point
}
#elif defined(LEFTOVER_ENVIRONMENT)
void begin_instance() {}
double next() {
  const char* const before = std::getenv("MEBOTS_TEST_STEPS");
  const int steps = before == nullptr ? 1 : std::atoi(before) + 1;
  setenv("MEBOTS_TEST_STEPS", std::to_string(steps).c_str(), 1);
  return steps;
}
#elif defined(LEFTOVER_TOKENS)
char text[] = "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20";
void begin_instance() {
  static bool is_begun = false;
  if (!is_begun) std::strtok(text, " ");
  is_begun = true;
}
double next() {
  const char* const token = std::strtok(nullptr, " ");
  return token == nullptr ? 0 : std::atoi(token);
}
#endif

}  // namespace

FMI2_VERSIONS

fmi2Component fmi2Instantiate(fmi2String, fmi2Type, fmi2String guid, fmi2String, const fmi2CallbackFunctions*,
                              fmi2Boolean, fmi2Boolean) {
  if (std::strcmp(guid, "{leftover}") != 0) return nullptr;
  begin_instance();
  return new (std::nothrow) Instance;
}
void fmi2FreeInstance(fmi2Component component) {
  delete static_cast<Instance*>(component);
}
FMI2_ANSWER(fmi2OK, fmi2SetupExperiment, fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real)
FMI2_ANSWER(fmi2OK, fmi2EnterInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2ExitInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Terminate, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Reset, fmi2Component)
FMI2_VALUES(Real, reals_of, kRealCount, changed)
FMI2_NO_VALUES(Integer)
FMI2_NO_VALUES(Boolean)
FMI2_NO_VALUES(String)

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real, fmi2Real, fmi2Boolean) {
  reals_of(component)[kSum] += reals_of(component)[kGain] * next();
  return fmi2OK;
}

// A saved state contains only the data of the instance.
fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  if (*state == nullptr) *state = new (std::nothrow) Instance;
  std::memcpy(*state, component, sizeof(Instance));
  return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  std::memcpy(component, state, sizeof(Instance));
  return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component, fmi2FMUstate* state) {
  delete static_cast<Instance*>(*state);
  *state = nullptr;
  return fmi2OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate, std::size_t* size) {
  *size = sizeof(Instance);
  return fmi2OK;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component, fmi2FMUstate state, fmi2Byte bytes[], std::size_t size) {
  std::memcpy(bytes, state, size);
  return fmi2OK;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component, const fmi2Byte bytes[], std::size_t size, fmi2FMUstate* state) {
  if (*state == nullptr) *state = new (std::nothrow) Instance;
  std::memcpy(*state, bytes, size);
  return fmi2OK;
}
FMI2_NO_DIRECTIONAL_DERIVATIVE
FMI2_NO_TIME_DERIVATIVES
FMI2_NO_PENDING_STEPS
FMI2_NO_REAL_STATUS
FMI2_NO_OTHER_STATUS
