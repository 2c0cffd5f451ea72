// SPDX-License-Identifier: Apache-2.0
// Functions that the linked archives call in place of those of the C library: see fmu_world/CMakeLists.txt.
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
