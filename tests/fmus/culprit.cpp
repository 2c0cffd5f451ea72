// SPDX-License-Identifier: Apache-2.0
// A lag, dy/dt = (u - y) / 1 s. If its GUID contains the name of a fault, such as "{culprit:leak}", the FMU commits
// this fault.
#include "mebots/fmi2/functions.hpp"

#include "frame.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cfenv>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

namespace {

enum class Phase { instantiated, initialization, stepping, terminated };
enum Reference : fmi2ValueReference { kU, kY, kGain };

struct State {
  Phase phase = Phase::instantiated;
  bool set_up = false;
  double u = 1;
  double y = 0;
  double gain = 2;
  double time = 0;
};

struct Culprit {
  State state;
  std::string name;
  std::string crime;
  fmi2CallbackFunctions callbacks{};

  bool does(const char* what) const { return crime == what; }
  fmi2Status refuse(const char* why) {
    const bool anonymous = does("name");
    callbacks.logger(callbacks.componentEnvironment, anonymous ? "somebody" : name.c_str(), fmi2Error,
                     does("category") ? "gossip" : "logStatusError", "%s", why);
    return fmi2Error;
  }
};

double shared_y = 0;  // NOLINT: what the crime "global" is about

Culprit& self(fmi2Component component) {
  return *static_cast<Culprit*>(component);
}

fmi2Status go(fmi2Component component, Phase from, Phase to, const char* why) {
  auto& c = self(component);
  if (c.state.phase != from) return c.refuse(why);
  c.state.phase = to;
  return fmi2OK;
}

double* field(Culprit& c, fmi2ValueReference reference) {
  if (reference == kU) return &c.state.u;
  if (reference == kY) return &c.state.y;
  return reference == kGain ? &c.state.gain : nullptr;
}

fmi2Status refuse_any(fmi2Component component, std::size_t count) {
  return count == 0 ? fmi2OK : self(component).refuse("there are only Reals here");
}

}  // namespace

FMI2_VERSIONS

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String,
                              const fmi2CallbackFunctions* callbacks, fmi2Boolean, fmi2Boolean) {
  constexpr const char* kStart = "{culprit:";
  if (type != fmi2CoSimulation || guid == nullptr || std::strncmp(guid, kStart, std::strlen(kStart)) != 0)
    return nullptr;
  auto* c = new Culprit;
  c->name = name;
  c->crime = std::string(guid + std::strlen(kStart));
  c->crime.pop_back();
  c->callbacks = *callbacks;
  if (c->does("start")) c->state.gain = 3;
  if (c->does("leak")) {
    void* volatile kept = std::malloc(1000);  // volatile, because the compiler would otherwise remove it
    (void)kept;
  }
  if (c->does("rounding")) std::fesetround(FE_UPWARD);
  if (c->does("file")) open("/dev/null", O_RDONLY);
  return c;
}

void fmi2FreeInstance(fmi2Component component) {
  if (component == nullptr) return;
  if (self(component).does("foreign_free")) self(component).callbacks.freeMemory(&shared_y);
  if (self(component).does("free") && self(component).state.phase == Phase::initialization) std::abort();
  delete static_cast<Culprit*>(component);
}

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean has_stop,
                               fmi2Real stop) {
  if (self(component).does("needs_stop") && has_stop == fmi2False) return self(component).refuse("no stop time");
  if (self(component).does("stop") && has_stop != fmi2False) self(component).state.gain = stop;
  self(component).state.set_up = true;
  self(component).state.time = start;
  return go(component, Phase::instantiated, Phase::instantiated, "the experiment is set up too late");
}
fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return go(component, Phase::instantiated, Phase::initialization, "cannot enter now");
}
fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  return go(component, Phase::initialization, Phase::stepping, "cannot exit now");
}
fmi2Status fmi2Terminate(fmi2Component component) {
  return go(component, Phase::stepping, Phase::terminated, "cannot terminate now");
}
fmi2Status fmi2Reset(fmi2Component component) {
  auto& c = self(component);
  const double y = c.state.y;
  c.state = State{};
  if (c.does("reset")) c.state.y = y;
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       fmi2Real values[]) {
  auto& c = self(component);
  if (count != 0 && (references == nullptr || values == nullptr)) {
    if (c.does("null")) values[0] = 0;
    return c.refuse("null array");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double* value = field(c, references[i]);
    if (value == nullptr) return c.refuse("unknown value reference");
    values[i] = *value;
  }
  return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], std::size_t count,
                       const fmi2Real values[]) {
  auto& c = self(component);
  if (count != 0 && (references == nullptr || values == nullptr)) return c.refuse("null array");
  for (std::size_t i = 0; i < count; ++i) {
    double* value = field(c, references[i]);
    if (value == nullptr) return c.refuse("unknown value reference");
    if (references[i] == kY) return c.refuse("y is an output");
    if (references[i] == kGain && c.state.phase == Phase::stepping && !c.does("fixed"))
      return c.refuse("gain is fixed");
    *value = values[i];
  }
  return fmi2OK;
}
fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference[], std::size_t count, fmi2Integer[]) {
  return refuse_any(component, count);
}
fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference[], std::size_t count, const fmi2Integer[]) {
  return refuse_any(component, count);
}
fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference[], std::size_t count, fmi2Boolean[]) {
  return refuse_any(component, count);
}
fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference[], std::size_t count, const fmi2Boolean[]) {
  return refuse_any(component, count);
}
fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference[], std::size_t count, fmi2String[]) {
  return refuse_any(component, count);
}
fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference[], std::size_t count, const fmi2String[]) {
  return refuse_any(component, count);
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  auto& c = self(component);
  if (state == nullptr) return c.refuse("no place for the state");
  if (*state == nullptr) *state = new State;
  *static_cast<State*>(*state) = c.state;
  return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  auto& c = self(component);
  if (state == nullptr) return c.refuse("no state");
  const double y = c.state.y;
  c.state = *static_cast<State*>(state);
  if (c.does("state")) c.state.y = y;
  return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component, fmi2FMUstate* state) {
  if (state == nullptr) return fmi2OK;
  delete static_cast<State*>(*state);
  *state = nullptr;
  return fmi2OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate, std::size_t* size) {
  *size = sizeof(State);
  return fmi2OK;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], std::size_t size) {
  if (size < sizeof(State)) return self(component).refuse("too few bytes");
  std::memcpy(bytes, state, sizeof(State));
  return fmi2OK;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], std::size_t size,
                                   fmi2FMUstate* state) {
  auto& c = self(component);
  if (size != sizeof(State)) return c.refuse("this is not a state");
  auto* fresh = new State;
  std::memcpy(fresh, bytes, size);
  if (c.does("bytes")) fresh->y = 0;
  *state = fresh;
  return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real point, fmi2Real h, fmi2Boolean) {
  if (component == nullptr) return fmi2Error;
  auto& c = self(component);
  if (c.state.phase != Phase::stepping) {
    if (c.does("crash")) std::raise(SIGSEGV);
    return c.does("order") ? fmi2OK : c.refuse("cannot step now");
  }
  if (!(h > 0)) return c.refuse("a step above 0 is needed");
  if (std::abs(point - c.state.time) > 1e-9) return c.refuse("the step starts at another time");
  if (c.does("exit")) std::exit(3);
  if (c.does("umask") && c.state.time > 0.25) umask(0);
  if (c.does("heap")) {  // damages the shared heap, and logs a message
    auto* volatile block = static_cast<char*>(std::malloc(1000));
    std::memset(block, 'x', 60000);
    static const std::string text(20000, 'y');
    c.refuse(text.c_str());
    void* volatile more = std::malloc(20000);
    std::free(more);
  }
  if (c.does("sleep")) pause();
  for (volatile bool endless = c.does("hang"); endless;) {
  }
  c.state.time = point + h;
  double& y = c.does("global") ? shared_y : c.state.y;
  const double target = c.state.gain * c.state.u;
  y = c.does("coarse") ? y + h * (target - y) : target + (y - target) * std::exp(-h);
  if (c.does("nan")) y = std::numeric_limits<double>::quiet_NaN();
  if (c.does("limits")) y = 1000;
  c.state.y = y;
  if (!c.does("ends") || c.state.time < 1.5 - 1e-9) return fmi2OK;
  c.state.phase = Phase::terminated;
  return fmi2Discard;
}

FMI2_NO_DIRECTIONAL_DERIVATIVE
FMI2_NO_TIME_DERIVATIVES
FMI2_NO_PENDING_STEPS
FMI2_NO_REAL_STATUS
FMI2_ANSWER(fmi2Discard, fmi2GetIntegerStatus, fmi2Component, fmi2StatusKind, fmi2Integer*)
FMI2_ANSWER(fmi2Discard, fmi2GetStringStatus, fmi2Component, fmi2StatusKind, fmi2String*)
fmi2Status fmi2GetBooleanStatus(fmi2Component component, fmi2StatusKind kind, fmi2Boolean* value) {
  if (kind != fmi2Terminated) return fmi2Discard;
  *value = self(component).state.phase == Phase::terminated ? fmi2True : fmi2False;
  return fmi2OK;
}
