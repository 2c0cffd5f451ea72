// SPDX-License-Identifier: Apache-2.0
// Ends the program.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

// Exit codes of the flight application, which are the values of the chip's output core.exit_code.
enum {
  EXIT_GATE_CROSSED = 0,    // landed after the gate was crossed, according to the state estimate
  EXIT_LANDED_EARLY = 1,    // landed at the landing charge, without crossing the gate
  EXIT_CRASHED = 2,         // the flight controller has reported a crash
  EXIT_TOO_LOW_CHARGE = 3,  // did not take off, because the charge was too low
  EXIT_CAMERA = 4,          // landed because the camera refused a request
  EXIT_EXCEPTION = 255      // an exception had no handler
};

__attribute__((noreturn)) void firmware_exit(int code);

#ifdef __cplusplus
}
#endif
