// SPDX-License-Identifier: Apache-2.0
// Flies a mission with the sight network. After take-off, a loop takes a picture, computes the set-points, and sleeps
// until the next picture. The drone lands after the last gate, or when the charge is low.
#include <stdbool.h>
#include <stdint.h>

#include "app/sight.h"
#include "app/traverser.h"
#include "board.h"
#include "drivers/camera.h"
#include "drivers/flight.h"
#include "drivers/timer.h"
#include "runtime/console.h"
#include "runtime/core.h"
#include "runtime/exit.h"
#include "runtime/interrupt.h"

// Time between two checks of the flight phase during climb and descent.
#define PHASE_POLL_NS (20 * NS_PER_MS)
// Number of pictures between two printed lines about the flight.
#define PICTURES_PER_LINE 10

typedef struct {
  uint32_t pictures;
  uint32_t sightings;    // pictures that contain a gate
  uint32_t late;         // pictures that did not arrive in time
  uint32_t overruns;     // frame periods without a picture, because the work took too long
  int64_t look_most_ns;  // longest time of the work on a picture
} statistics_t;

static statistics_t statistics;

static void command(uint32_t mode, const traverser_command_t* order) {
  const setpoint_t setpoint = {mode, order->velocity_um_s, order->yaw_rate_urad_s, order->altitude_um};
  flight_command(&setpoint);
}

// Sleeps until the flight phase is `wanted`. Returns false if the drone crashes, or if the charge is below
// `least_charge_ppm`.
static bool wait_for_phase(uint32_t wanted, uint32_t least_charge_ppm) {
  for (int64_t next_ns = timer_now_ns();;) {
    const uint32_t phase = flight_phase();
    if (phase == wanted) {
      return true;
    }
    if (phase == FLIGHT_PHASE_CRASHED || battery_charge_ppm() < least_charge_ppm) {
      return false;
    }
    next_ns += PHASE_POLL_NS;
    timer_sleep_until(next_ns);
  }
}

static sight_t look(const picture_t* picture) {
  const int64_t start_ns = timer_now_ns();
  const sight_t sight = cluster_sight(picture->pixels, picture->width, picture->height);
  const int64_t took_ns = timer_now_ns() - start_ns;
  if (took_ns > statistics.look_most_ns) {
    statistics.look_most_ns = took_ns;
  }
  ++statistics.pictures;
  statistics.sightings += sight.visible > 0 ? 1 : 0;
  return sight;
}

static void print_decision(const traverser_t* traverser, const sight_t* sight, const traverser_command_t* order) {
  static const char* const kPhases[] = {"search", "approach", "through", "elsewhere", "done"};
  print("%m s  picture %u, %s", (int32_t)(timer_now_ns() / NS_PER_MS), statistics.pictures, kPhases[traverser->phase]);
  if (sight->visible > 0) {
    print(", gate at %m, %m, size %m", sight->yaw * 1000 / 127, sight->rise * 1000 / 127,
          sight->size * SIGHT_MOST_SIZE * 1000 / 127);
  } else {
    print(", no gate in the picture");
  }
  print(", speed %M m/s, yaw rate %M rad/s, altitude %M m, charge %M\n", order->velocity_um_s, order->yaw_rate_urad_s,
        order->altitude_um, (int32_t)battery_charge_ppm());
}

static traverser_t traverser_of_mission(void) {
  policy_t policy;
  policy_init(&policy, MISSION_POLICY == POLICY_ADAPTIVE, (int32_t)MISSION_CRUISE_SPEED,
              (int32_t)MISSION_INITIAL_SPEED);
  traverser_t traverser;
  traverser_init(&traverser, &policy, (int32_t)MISSION_YAW_RATE_SCALE, (int32_t)MISSION_ALTITUDE, flight_yaw_urad(),
                 (int)MISSION_GATES);
  return traverser;
}

// Runs the loop from picture to set-points. `order` is the last command sent. Returns the exit code of the flight.
static int fly(traverser_command_t* order) {
  traverser_t traverser = traverser_of_mission();
  const int64_t period_ns = (int64_t)MISSION_FRAME_PERIOD * NS_PER_US;
  int64_t frame_ns = timer_now_ns();  // time at which the next picture is requested
  int64_t last_ns = frame_ns;
  bool requested = false;
  while (traverser.phase != TRAVERSER_DONE) {
    if (flight_phase() == FLIGHT_PHASE_CRASHED) {
      return EXIT_CRASHED;
    }
    if (battery_charge_ppm() <= MISSION_LANDING_CHARGE) {
      print("charge %M: time to land\n", (int32_t)battery_charge_ppm());
      return EXIT_LANDED_EARLY;
    }
    picture_t picture;
    sight_t sight = {0, 0, 0, -127};
    camera_result_t result = PICTURE_REFUSED;
    if (requested || camera_ask()) {
      result = camera_wait(&picture, frame_ns + 5 * period_ns);
    }
    const int64_t here_ns = timer_now_ns();
    for (frame_ns += period_ns; frame_ns + period_ns <= here_ns; frame_ns += period_ns) {
      ++statistics.overruns;
    }
    if (result == PICTURE_REFUSED) {
      print("the camera refuses to take pictures\n");
      return EXIT_CAMERA;
    }
    requested = true;
    if (result == PICTURE_TAKEN) {
      // If the next picture is due during the work on this picture, requests the next picture now.
      requested = here_ns + statistics.look_most_ns > frame_ns && camera_ask();
      sight = look(&picture);
    } else {
      ++statistics.late;
    }

    const int64_t now_ns = timer_now_ns();
    const traverser_phase_t before = traverser.phase;
    const traverser_state_t state = {flight_forward_velocity_um_s(), flight_range_um(),
                                     (int32_t)((now_ns - last_ns) / NS_PER_US), flight_yaw_urad()};
    *order = traverser_step(&traverser, &sight, &state);
    last_ns = now_ns;
    command(FLIGHT_MODE_FLY, order);
    if (traverser.phase != before || statistics.pictures % PICTURES_PER_LINE == 1) {
      print_decision(&traverser, &sight, order);
    }
    if (!requested) {
      timer_sleep_until(frame_ns);
    }
  }
  return EXIT_GATE_CROSSED;
}

static void print_summary(int code) {
  static const char* const kEnds[] = {"gate crossed, ended", "landed without the gate", "crashed", "did not take off",
                                      "landed, camera out of order"};
  print("%s after %m s: %u pictures, %u with a gate, %u late, %u periods overrun, vision took %m ms at most\n",
        kEnds[code], (int32_t)(timer_now_ns() / NS_PER_MS), statistics.pictures, statistics.sightings, statistics.late,
        statistics.overruns, (int32_t)(statistics.look_most_ns / NS_PER_US));
  print("battery: %m V, charge %M\n", (int32_t)battery_voltage_mv(), (int32_t)battery_charge_ppm());
}

int main(void) {
  interrupts_off();
  timer_init();
  camera_init();
  sleep_clock_set(MISSION_SLEEP_CLOCK);

  print("sight firmware: %s speed policy, cruise %M m/s at %M m, a picture every %m ms, core at %M MHz\n",
        MISSION_POLICY == POLICY_ADAPTIVE ? "adaptive" : "constant", (int32_t)MISSION_CRUISE_SPEED,
        (int32_t)MISSION_ALTITUDE, (int32_t)MISSION_FRAME_PERIOD, (int32_t)core_clock_hz());
  if (battery_charge_ppm() <= MISSION_LANDING_CHARGE) {
    print("charge %M is too low to take off\n", (int32_t)battery_charge_ppm());
    return EXIT_TOO_LOW_CHARGE;
  }

  traverser_command_t order = {0, 0, (int32_t)MISSION_ALTITUDE};
  command(FLIGHT_MODE_TAKE_OFF, &order);
  int code = EXIT_LANDED_EARLY;
  if (wait_for_phase(FLIGHT_PHASE_FLYING, MISSION_LANDING_CHARGE)) {
    print("%m s  flying at %M m\n", (int32_t)(timer_now_ns() / NS_PER_MS), flight_range_um());
    code = fly(&order);
  }
  order.velocity_um_s = 0;
  order.yaw_rate_urad_s = 0;
  command(FLIGHT_MODE_LAND, &order);
  if (!wait_for_phase(FLIGHT_PHASE_LANDED, 0)) {
    code = EXIT_CRASHED;
  }
  print_summary(code);
  return code;
}
