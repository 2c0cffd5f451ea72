// SPDX-License-Identifier: Apache-2.0
// y = gain u after each step. TENANT_KIND selects the source of the gain: code or data that the loader may replace by
// code or data of another FMU in the process.
#include "mebots/fmi2/functions.hpp"

#include "frame.h"

#include <dlfcn.h>

#include <new>
#include <stdexcept>
#include <string>

#define TENANT_SHOWN [[gnu::visibility("default")]]

#if defined(TENANT_NEEDS)  // from a needed library inside the FMU
extern "C" double tenant_gain();
static double find_gain() {
  return tenant_gain();
}
#elif defined(TENANT_UNIQUE)     // from a variable of which a process has one copy, which counts the instances
                                 // there
struct Shown {
  TENANT_SHOWN static inline double gain = TENANT_GAIN;
  TENANT_SHOWN static inline int instances = 0;
};
static double find_gain() {
  return Shown::gain + 100 * Shown::instances++;
}
#elif defined(TENANT_OPENS)      // from a library that the FMU opens for the whole process
static double find_gain() {
  Dl_info info{};
  dladdr(reinterpret_cast<const void*>(&fmi2GetVersion), &info);
  const std::string file = info.dli_fname;
  if (dlopen((file.substr(0, file.rfind('/')) + "/libplugin.so").c_str(), RTLD_NOW | RTLD_GLOBAL) == nullptr) return -1;
  auto* const gain = reinterpret_cast<double (*)()>(dlsym(RTLD_DEFAULT, "tenant_gain"));
  return gain == nullptr ? -2 : gain();
}
#elif defined(TENANT_PREEMPTED)  // from a function with the name of one in zlib, which mebots loads
// NOLINTBEGIN(readability-identifier-naming): zlib's name
extern "C" {
TENANT_SHOWN unsigned long zlibCompileFlags();
TENANT_SHOWN unsigned long zlibCompileFlags() {
  return TENANT_GAIN;
}
}
// NOLINTEND(readability-identifier-naming)
static double find_gain() {
  return static_cast<double>(zlibCompileFlags());
}
#elif defined(TENANT_WEAK)       // from a template whose instances the linker merges
template <typename T>
TENANT_SHOWN __attribute__((noinline)) T weak_gain(T value) {
  return value * TENANT_GAIN;
}
static double find_gain() {
  double (*volatile gain)(double) = &weak_gain<double>;
  return gain(1);
}
#endif

namespace {

enum Reference : fmi2ValueReference { kU, kY, kRealCount };

struct Tenant {
  fmi2Real reals[kRealCount] = {};
  double gain = 0;
};

Tenant& self(fmi2Component component) {
  return *static_cast<Tenant*>(component);
}

/// Returns the gain. Throws and catches an exception that contains it, so that the C++ runtime is used.
double thrown_gain() {
  try {
    throw std::out_of_range(std::to_string(find_gain()));
  } catch (const std::exception& error) {
    return std::stod(error.what());
  }
}

}  // namespace

#define TENANT_REALS(component) self(component).reals
#define TENANT_NOTHING(component)

FMI2_VERSIONS

fmi2Component fmi2Instantiate(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions*, fmi2Boolean,
                              fmi2Boolean) {
  auto* const tenant = new (std::nothrow) Tenant;
  tenant->gain = thrown_gain();
  return tenant;
}
void fmi2FreeInstance(fmi2Component component) {
  delete static_cast<Tenant*>(component);
}
FMI2_ANSWER(fmi2OK, fmi2SetupExperiment, fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real)
FMI2_ANSWER(fmi2OK, fmi2EnterInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2ExitInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Terminate, fmi2Component)
FMI2_ANSWER(fmi2Error, fmi2Reset, fmi2Component)
FMI2_VALUES(Real, TENANT_REALS, kRealCount, TENANT_NOTHING)
FMI2_NO_VALUES(Integer)
FMI2_NO_VALUES(Boolean)
FMI2_NO_VALUES(String)

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real, fmi2Real, fmi2Boolean) {
  auto& tenant = self(component);
  tenant.reals[kY] = tenant.gain * tenant.reals[kU];
  return fmi2OK;
}

FMI2_NO_STATE
FMI2_NO_BYTES
FMI2_NO_DIRECTIONAL_DERIVATIVE
FMI2_NO_TIME_DERIVATIVES
FMI2_NO_PENDING_STEPS
FMI2_NO_REAL_STATUS
FMI2_NO_OTHER_STATUS
