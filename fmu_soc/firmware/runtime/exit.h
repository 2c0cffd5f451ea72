// SPDX-License-Identifier: Apache-2.0
// Ends the firmware.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

// Exit codes of the flight application, which are the output core.exit_code of the chip.
enum {
  EXIT_GATE_CROSSED = 0,    // crossed the opening, as far as it knows, and landed
  EXIT_LANDED_EARLY = 1,    // landed at the landing charge, without the gate
  EXIT_CRASHED = 2,         // the flight controller reports a crash
  EXIT_TOO_LOW_CHARGE = 3,  // did not take off
  EXIT_CAMERA = 4,          // the camera refused; landed
  EXIT_EXCEPTION = 255      // exception without a handler
};

// Ends the program with an exit code. The core does not run again.
__attribute__((noreturn)) void firmware_exit(int code);

#ifdef __cplusplus
}
#endif
