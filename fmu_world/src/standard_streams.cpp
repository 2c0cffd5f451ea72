// SPDX-License-Identifier: Apache-2.0
// Definitions that the linked archives use in place of the C library's (see fmu_world/CMakeLists.txt).
#include <cstdio>
#include <cstdlib>

extern "C" {
std::FILE* mebots_stdout = stdout;
std::FILE* mebots_stderr = stderr;

int mebots_rand() {
  std::abort();
}
void mebots_srand(unsigned /*seed*/) {
  std::abort();
}
}
