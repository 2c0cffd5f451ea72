// SPDX-License-Identifier: Apache-2.0
// Flies the mission of the paper (examples/paper). After take-off, a loop takes a picture, computes the direction to
// the gate and the set-points, and sleeps until the next picture. The drone lands after the gate, or when the charge is
// low.
#include <stdbool.h>
#include <stdint.h>

#include "app/follower.h"
#include "app/navigator.h"
#include "app/pilot.h"
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
  uint32_t sightings;   // pictures that contain a gate
  uint32_t late;        // pictures that did not arrive in time
  uint32_t overruns;    // frame periods without a picture, because the work took too long
  uint32_t overlapped;  // pictures that were exposed during the work on the previous picture
  uint64_t instructions;
  uint32_t instructions_most;
  int64_t look_most_ns;  // longest time of the work on a picture
} statistics_t;

static statistics_t statistics;

// A navigator with its pilot. With the gate finder, the pilot searches for gates and uses distances. With the network,
// the follower flies with the network's yaw.
typedef struct {
  navigator_t* navigate;
  bool follows;
  pilot_t pilot;
  follower_t follower;
} crew_t;

static uint32_t retired_instructions(void) {
  uint32_t count;
  __asm__ volatile("csrr %0, minstret" : "=r"(count)::"memory");
  return count;
}

static void command(uint32_t mode, int32_t velocity_um_s, int32_t yaw_rate_urad_s) {
  const setpoint_t setpoint = {mode, velocity_um_s, yaw_rate_urad_s, (int32_t)MISSION_ALTITUDE};
  flight_command(&setpoint);
}

// Sleeps until the flight phase is `wanted`. Returns false if the drone crashes, or if the charge is below
// `least_charge_ppm`.
static bool wait_for_phase(uint32_t wanted, uint32_t least_charge_ppm) {
  int64_t next_ns = timer_now_ns();
  for (;;) {
    const uint32_t phase = flight_phase();
    if (phase == wanted) {
      return true;
    }
    if (phase == FLIGHT_PHASE_CRASHED || battery_charge_ppm() < least_charge_ppm) {
      return false;
    }
    flight_repeat();
    next_ns += PHASE_POLL_NS;
    timer_sleep_until(next_ns);
  }
}

static navigator_output_t look(const crew_t* crew, const picture_t* picture) {
  const int64_t start_ns = timer_now_ns();
  const uint32_t before = retired_instructions();
  const navigator_output_t seen = crew->navigate(picture->pixels, picture->width, picture->height);
  const uint32_t spent = retired_instructions() - before;
  const int64_t took_ns = timer_now_ns() - start_ns;
  if (took_ns > statistics.look_most_ns) {
    statistics.look_most_ns = took_ns;
  }
  ++statistics.pictures;
  statistics.sightings += seen.confidence > 0 ? 1 : 0;
  statistics.instructions += spent;
  if (spent > statistics.instructions_most) {
    statistics.instructions_most = spent;
  }
  return seen;
}

static crew_t crew_of_mission(void) {
  policy_t policy;
  policy_init(&policy, MISSION_POLICY == POLICY_ADAPTIVE, (int32_t)MISSION_CRUISE_SPEED,
              (int32_t)MISSION_INITIAL_SPEED);
  crew_t crew;
  crew.follows = MISSION_NAVIGATOR == NAVIGATOR_NETWORK;
  crew.navigate = crew.follows ? cluster_navigate : finder_navigate;
  pilot_init(&crew.pilot, &policy, (int32_t)MISSION_YAW_RATE_SCALE);
  follower_init(&crew.follower, &policy, (int32_t)MISSION_YAW_RATE_SCALE);
  return crew;
}

static pilot_phase_t phase_of(const crew_t* crew) {
  return crew->follows ? crew->follower.phase : crew->pilot.phase;
}

static pilot_command_t steer(crew_t* crew, const navigator_output_t* seen, int32_t elapsed_us) {
  const int32_t velocity_um_s = flight_forward_velocity_um_s();
  return crew->follows ? follower_step(&crew->follower, seen->yaw, flight_gate_crossed(), velocity_um_s, elapsed_us)
                       : pilot_step(&crew->pilot, seen, velocity_um_s, elapsed_us);
}

static void print_decision(const crew_t* crew, const navigator_output_t* seen, const pilot_command_t* order) {
  static const char* const kPhases[] = {"search", "approach", "through", "done"};
  print("%m s  picture %u, %s", (int32_t)(timer_now_ns() / NS_PER_MS), statistics.pictures, kPhases[phase_of(crew)]);
  if (crew->follows) {
    print(", output %m", seen->yaw * 1000 / 127);
  } else if (seen->confidence > 0) {
    print(", gate at %m m, output %m, confidence %u", (int32_t)seen->distance_mm, seen->yaw * 1000 / 127,
          (uint32_t)seen->confidence);
  } else {
    print(", no gate in the picture");
  }
  if (!crew->follows) {
    print("; %M m to go", crew->pilot.remaining_um);
  }
  print(", speed %M m/s, yaw rate %M rad/s, charge %M\n", order->velocity_um_s, order->yaw_rate_urad_s,
        (int32_t)battery_charge_ppm());
}

// Runs the loop from picture to set-points. Returns the exit code of the flight.
static int fly(crew_t* crew) {
  const int64_t period_ns = (int64_t)MISSION_FRAME_PERIOD * NS_PER_US;
  int64_t frame_ns = timer_now_ns();  // time at which the next picture is requested
  int64_t last_ns = frame_ns;
  bool requested = false;
  for (;;) {
    if (flight_phase() == FLIGHT_PHASE_CRASHED) {
      return EXIT_CRASHED;
    }
    if (battery_charge_ppm() <= MISSION_LANDING_CHARGE) {
      print("charge %M: time to land\n", (int32_t)battery_charge_ppm());
      return EXIT_LANDED_EARLY;
    }

    picture_t picture;
    navigator_output_t seen = {0, 0, 0};
    camera_result_t result = PICTURE_REFUSED;
    if (requested || camera_ask()) {
      result = camera_wait(&picture, frame_ns + 5 * period_ns);
    }
    const int64_t here_ns = timer_now_ns();
    for (frame_ns += period_ns; frame_ns + period_ns <= here_ns; frame_ns += period_ns) {
      ++statistics.overruns;
    }
    if (result == PICTURE_TAKEN) {
      // If the next picture is due during the work on this picture, requests the next picture now.
      requested = here_ns + statistics.look_most_ns > frame_ns && camera_ask();
      statistics.overlapped += requested ? 1 : 0;
      seen = look(crew, &picture);
    } else if (result == PICTURE_LATE) {
      requested = true;
      ++statistics.late;
    } else {
      print("the camera refuses to take pictures\n");
      return EXIT_CAMERA;
    }

    const int64_t now_ns = timer_now_ns();
    const pilot_phase_t before = phase_of(crew);
    const pilot_command_t order = steer(crew, &seen, (int32_t)((now_ns - last_ns) / NS_PER_US));
    last_ns = now_ns;
    command(FLIGHT_MODE_FLY, order.velocity_um_s, order.yaw_rate_urad_s);
    if (phase_of(crew) != before || statistics.pictures % PICTURES_PER_LINE == 1) {
      print_decision(crew, &seen, &order);
    }
    if (phase_of(crew) == PILOT_DONE) {
      return EXIT_GATE_CROSSED;
    }

    if (!requested) {
      timer_sleep_until(frame_ns);
    }
  }
}

static void print_summary(int code) {
  static const char* const kEnds[] = {"gate crossed, ended", "landed without the gate", "crashed", "did not take off",
                                      "landed, camera out of order"};
  print("%s after %m s: %u pictures, %u with a gate, %u late, %u periods overrun\n", kEnds[code],
        (int32_t)(timer_now_ns() / NS_PER_MS), statistics.pictures, statistics.sightings, statistics.late,
        statistics.overruns);
  print("vision took %m ms at most; %u pictures were exposed during it.\n",
        (int32_t)(statistics.look_most_ns / NS_PER_US), statistics.overlapped);
  if (statistics.pictures > 0) {
    print("FC instructions per picture: mean %u, max %u\n", (uint32_t)(statistics.instructions / statistics.pictures),
          statistics.instructions_most);
  }
  print("battery: %m V, charge %M\n", (int32_t)battery_voltage_mv(), (int32_t)battery_charge_ppm());
}

int main(void) {
  interrupts_off();
  timer_init();
  camera_init();
  sleep_clock_set(MISSION_SLEEP_CLOCK);

  print("gate firmware: %s, %s speed policy, cruise %M m/s at %M m, a picture every %m ms, core at %M MHz\n",
        MISSION_NAVIGATOR == NAVIGATOR_NETWORK ? "neural network" : "gate finder",
        MISSION_POLICY == POLICY_ADAPTIVE ? "adaptive" : "constant", (int32_t)MISSION_CRUISE_SPEED,
        (int32_t)MISSION_ALTITUDE, (int32_t)MISSION_FRAME_PERIOD, (int32_t)core_clock_hz());
  if (battery_charge_ppm() <= MISSION_LANDING_CHARGE) {
    print("charge %M is too low to take off\n", (int32_t)battery_charge_ppm());
    return EXIT_TOO_LOW_CHARGE;
  }

  command(FLIGHT_MODE_TAKE_OFF, 0, 0);
  int code = EXIT_LANDED_EARLY;
  if (wait_for_phase(FLIGHT_PHASE_FLYING, MISSION_LANDING_CHARGE)) {
    print("%m s  flying at %M m\n", (int32_t)(timer_now_ns() / NS_PER_MS), flight_range_um());
    crew_t crew = crew_of_mission();
    code = fly(&crew);
  }
  command(FLIGHT_MODE_LAND, 0, 0);
  if (!wait_for_phase(FLIGHT_PHASE_LANDED, 0)) {
    code = EXIT_CRASHED;
  }
  print_summary(code);
  return code;
}
