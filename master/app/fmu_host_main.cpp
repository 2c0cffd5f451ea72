// SPDX-License-Identifier: Apache-2.0
#include "slave/isolation/child_process.hpp"

#ifdef __SANITIZE_ADDRESS__
/// LeakSanitizer stops threads as a debugger does. This process forbids debugging, even by itself, so the check for
/// leaks is turned off.
extern "C" [[gnu::visibility("default")]] int __lsan_is_turned_off() {  // NOLINT: the library's name
  return 1;
}
#endif

int main(int argument_count, char** arguments) {
  return mebots::master::run_fmu_host(argument_count, arguments);
}
