// SPDX-License-Identifier: Apache-2.0
// Functions of FMI 3.0 that do nothing, for test FMUs. The definitions are weak: an FMU whose modes have effects
// defines the function itself.
#include "mebots/fmi3/functions.hpp"

#define FMI3_NOTHING(function)                              \
  __attribute__((weak)) fmi3Status function(fmi3Instance) { \
    return fmi3OK;                                          \
  }

__attribute__((weak)) const char* fmi3GetVersion() {
  return "3.0";
}

FMI3_NOTHING(fmi3EnterConfigurationMode)
FMI3_NOTHING(fmi3ExitConfigurationMode)
FMI3_NOTHING(fmi3ExitInitializationMode)
FMI3_NOTHING(fmi3EnterEventMode)
FMI3_NOTHING(fmi3EnterContinuousTimeMode)
FMI3_NOTHING(fmi3EnterStepMode)
FMI3_NOTHING(fmi3Terminate)
