// SPDX-License-Identifier: Apache-2.0
// How the firmware ends.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

// Exit codes of the flight application; the chip puts them out as core.exit_code.
enum {
  EXIT_GATE_CROSSED = 0,    // crossed the opening, as far as it knows, and landed
  EXIT_LANDED_EARLY = 1,    // landed at the landing charge, without the gate
  EXIT_CRASHED = 2,         // the flight controller reports a crash
  EXIT_TOO_LOW_CHARGE = 3,  // did not take off
  EXIT_CAMERA = 4,          // the camera refuses to work; landed
  EXIT_EXCEPTION = 255      // trap that nobody handles
};

// Tells the power manager that the firmware is done; the core sleeps for good.
__attribute__((noreturn)) void firmware_exit(int code);

#ifdef __cplusplus
}
#endif
