// SPDX-License-Identifier: Apache-2.0
// What ODE's archive calls stdout and stderr, see fmu_world/CMakeLists.txt.
#include <cstdio>

extern "C" {
std::FILE* mebots_ode_stdout = stdout;
std::FILE* mebots_ode_stderr = stderr;
}
