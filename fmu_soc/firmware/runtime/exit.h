// SPDX-License-Identifier: Apache-2.0
// Ends the program.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

// Exit codes of the flight application. The output core.exit_code of the chip has this value.
enum {
  EXIT_GATE_CROSSED = 0,    // landed after it had, by its own estimate, crossed the gate
  EXIT_LANDED_EARLY = 1,    // landed at the landing charge, without crossing the gate
  EXIT_CRASHED = 2,         // the flight controller has reported a crash
  EXIT_TOO_LOW_CHARGE = 3,  // did not take off, because the charge was too low
  EXIT_CAMERA = 4,          // landed because the camera refused a request
  EXIT_EXCEPTION = 255      // an exception had no handler
};

// Ends the program with an exit code. The core does not run again.
__attribute__((noreturn)) void firmware_exit(int code);

#ifdef __cplusplus
}
#endif
