// SPDX-License-Identifier: Apache-2.0
// Node 1 flies a square and broadcasts its position. Each other node keeps its distance to node 1. It measures the
// distance by ultra-wideband, and computes the direction from both positions.
#include "board.h"
#include "drivers/timer.h"
#include "radio.h"
#include "runtime/console.h"

#define PERIOD_NS (20 * NS_PER_MS)
#define PERIODS_PER_S 50
#define ALTITUDE_UM 1000000
#define SIDE_S 4             // duration of a side of the square
#define LEADER_UM_S 300000   // speed along a side
#define FASTEST_UM_S 800000  // maximum speed of a follower along each axis
#define GAIN_PER_S 1         // velocity per distance error
#define FAR_MM 30000         // root() accepts the sum of two squares of this value, but not of 33000
#define LEADER 1

static void fly(uint32_t mode, int32_t x_um_s, int32_t y_um_s) {
  FLIGHT_MODE = mode;
  FLIGHT_VELOCITY_X = (uint32_t)x_um_s;
  FLIGHT_VELOCITY_Y = (uint32_t)y_um_s;
  FLIGHT_YAW_RATE = 0;
  FLIGHT_ALTITUDE = ALTITUDE_UM;
  FLIGHT_COMMIT = 1;
}

static int32_t limited(int32_t value, int32_t most) {
  return value > most ? most : value < -most ? -most : value;
}

static int32_t root(int32_t square) {
  int32_t result = 0;
  for (int32_t bit = 1 << 15; bit != 0; bit >>= 1) {
    if ((result + bit) <= square / (result + bit)) {
      result += bit;
    }
  }
  return result;
}

// Flies the leader along the four sides of the square. After the last side, the leader hovers.
static void lead(int flown_periods) {
  static const int8_t kSides[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  const int side = flown_periods / (SIDE_S * PERIODS_PER_S);
  if (side < 4) {
    fly(FLIGHT_MODE_FLY, kSides[side][0] * LEADER_UM_S, kSides[side][1] * LEADER_UM_S);
  } else {
    fly(FLIGHT_MODE_FLY, 0, 0);
  }
}

typedef struct {
  int32_t own_mm[2];
  int32_t leader_mm[2];
  int32_t leader_mm_s[2];
  int32_t leader_ms;    // time at which the leader sent its position
  int32_t distance_mm;  // measured distance to the leader
  int heard_before;     // number of periods since the last packet
  bool knows_leader;
} view_t;

static void hear(view_t* view) {
  radio_packet_t packet;
  uint32_t from = 0;
  ++view->heard_before;
  if (!radio_receive(&packet, &from) || from != LEADER) {
    return;
  }
  const int32_t elapsed_ms = packet.words[2] - view->leader_ms;
  for (int axis = 0; axis < 2; ++axis) {
    if (view->knows_leader && elapsed_ms > 0) {
      const int32_t now_mm_s = (packet.words[axis] - view->leader_mm[axis]) * 1000 / elapsed_ms;
      view->leader_mm_s[axis] += (now_mm_s - view->leader_mm_s[axis]) / 8;  // smooths the noise of the positions
    }
    view->leader_mm[axis] = packet.words[axis];
  }
  view->leader_ms = packet.words[2];
  view->heard_before = 0;
  view->knows_leader = true;
}

static void follow(view_t* view) {
  const int patience = (int)NODE_PATIENCE / (1000 / PERIODS_PER_S);
  const int32_t x_mm = limited(view->leader_mm[0] - view->own_mm[0], FAR_MM);
  const int32_t y_mm = limited(view->leader_mm[1] - view->own_mm[1], FAR_MM);
  const int32_t apart_mm = root(x_mm * x_mm + y_mm * y_mm);
  if (!view->knows_leader || view->heard_before > patience || view->distance_mm == 0 || apart_mm == 0) {
    fly(FLIGHT_MODE_FLY, 0, 0);
    return;
  }
  const int32_t error_mm = limited(view->distance_mm - (int32_t)NODE_DISTANCE, 1000);
  const int32_t x_mm_s = view->leader_mm_s[0] + GAIN_PER_S * error_mm * x_mm / apart_mm;
  const int32_t y_mm_s = view->leader_mm_s[1] + GAIN_PER_S * error_mm * y_mm / apart_mm;
  fly(FLIGHT_MODE_FLY, limited(1000 * x_mm_s, FASTEST_UM_S), limited(1000 * y_mm_s, FASTEST_UM_S));
}

int main(void) {
  timer_init();
  int64_t time_ns = timer_now_ns();
  view_t view = {0};
  int flown = 0;
  const bool leads = NODE_NUMBER == LEADER;
  while (FLIGHT_PHASE < FLIGHT_PHASE_LANDED) {
    int32_t x_mm = 0;
    int32_t y_mm = 0;
    if (radio_position(&x_mm, &y_mm)) {
      view.own_mm[0] = x_mm;
      view.own_mm[1] = y_mm;
    }
    if (leads) {
      const radio_packet_t packet = {{view.own_mm[0], view.own_mm[1], (int32_t)(time_ns / NS_PER_MS)}};
      radio_send(RADIO_ALL, &packet);
    } else {
      hear(&view);
      int32_t distance_mm = 0;
      if (radio_distance(&distance_mm)) {
        view.distance_mm = distance_mm;
      }
      radio_request_distance(LEADER);
    }
    if (FLIGHT_PHASE != FLIGHT_PHASE_FLYING) {
      fly(FLIGHT_MODE_TAKE_OFF, 0, 0);
    } else if (leads) {
      lead(flown++);
    } else {
      follow(&view);
    }
    time_ns += PERIOD_NS;
    timer_sleep_until(time_ns);
  }
  return 0;
}
