// SPDX-License-Identifier: Apache-2.0
#include "slave/isolation/child_process.hpp"

#ifdef __SANITIZE_ADDRESS__
/// Disables LeakSanitizer, which stops threads like a debugger. This process forbids debugging.
extern "C" [[gnu::visibility("default")]] int __lsan_is_turned_off() {  // NOLINT: the library's name
  return 1;
}
#endif

int main(int argument_count, char** arguments) {
  return mebots::master::run_fmu_host(argument_count, arguments);
}
