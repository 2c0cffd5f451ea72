// SPDX-License-Identifier: Apache-2.0
// What the archives that are linked in call stdout and stderr, see fmu_world/CMakeLists.txt.
#include <cstdio>

extern "C" {
std::FILE* mebots_stdout = stdout;
std::FILE* mebots_stderr = stderr;
}
