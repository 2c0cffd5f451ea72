// SPDX-License-Identifier: Apache-2.0
// Flies one leg of a relay. Drone 1 starts. At the end of its leg, a drone hovers and sends a packet to the next one
// until that drone replies. Then it lands. A drone that gets a packet from the previous one replies and takes off. It
// also replies after its landing, because replies may be lost.
#include "../../leader_follower/firmware/radio.h"
#include "board.h"
#include "drivers/timer.h"

#define PERIOD_NS (20 * NS_PER_MS)
#define PERIOD_MS 20
#define ALTITUDE_UM 1000000
#define SPEED_MM_S 500

enum { kGo = 1, kReply = 2 };  // first word of a packet

typedef struct {
  bool flies;     // it is drone 1, or has a packet from the previous drone
  bool is_done;   // the next drone has replied, or there is no next drone
  bool is_empty;  // the charge fell below the reserve before is_done
  int leg_ms;     // time of flight on the leg so far
  int silent_ms;  // time until the next packet to the next drone
} relay_t;

static void fly(uint32_t mode, int32_t x_mm_s) {
  FLIGHT_MODE = mode;
  FLIGHT_VELOCITY_X = (uint32_t)(1000 * x_mm_s);
  FLIGHT_VELOCITY_Y = 0;
  FLIGHT_YAW_RATE = 0;
  FLIGHT_ALTITUDE = ALTITUDE_UM;
  FLIGHT_COMMIT = 1;
}

static void send(uint32_t to, int32_t what) {
  const radio_packet_t packet = {{what, (int32_t)NODE_NUMBER, 0}};
  radio_send(to, &packet);
}

// Handles a received packet. The previous drone repeats its packet until a reply arrives. Therefore each packet gets a
// reply.
static void hear(relay_t* relay) {
  radio_packet_t packet;
  uint32_t from = 0;
  if (!radio_receive(&packet, &from)) {
    return;
  }
  if (packet.words[0] == kGo && from + 1 == NODE_NUMBER) {
    relay->flies = true;
    send(from, kReply);
  } else if (packet.words[0] == kReply && from == NODE_NUMBER + 1) {
    relay->is_done = true;
  }
}

static void fly_leg(relay_t* relay) {
  const int leg_ms = (int)(NODE_LEG * 1000 / SPEED_MM_S);
  if (relay->leg_ms < leg_ms) {
    relay->leg_ms += PERIOD_MS;
    fly(FLIGHT_MODE_FLY, SPEED_MM_S);
    return;
  }
  fly(FLIGHT_MODE_FLY, 0);
  if (NODE_NUMBER == NODE_COUNT) {
    relay->is_done = true;
  } else if ((relay->silent_ms -= PERIOD_MS) <= 0) {
    relay->silent_ms = (int)NODE_REPEAT;
    send(NODE_NUMBER + 1, kGo);
  }
}

int main(void) {
  timer_init();
  int64_t time_ns = timer_now_ns();
  relay_t relay = {.flies = NODE_NUMBER == 1};
  for (;;) {
    hear(&relay);
    relay.is_empty = relay.is_empty || (!relay.is_done && BATTERY_STATE_OF_CHARGE < NODE_RESERVE);
    if (relay.flies && (relay.is_done || relay.is_empty)) {
      fly(FLIGHT_MODE_LAND, 0);
    } else if (relay.flies && FLIGHT_PHASE < FLIGHT_PHASE_FLYING) {
      fly(FLIGHT_MODE_TAKE_OFF, 0);
    } else if (relay.flies) {
      fly_leg(&relay);
    }
    NODE_FINISHED = relay.is_done;
    NODE_EMPTY = relay.is_empty;
    time_ns += PERIOD_NS;
    timer_sleep_until(time_ns);
  }
}
