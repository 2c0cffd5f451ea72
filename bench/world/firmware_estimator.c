// SPDX-License-Identifier: Apache-2.0
// Calls the Kalman filter of a crazyflie-firmware checkout each millisecond, in the order of the firmware's estimator
// task. bench/world/firmware_estimate.py compiles this file with the checkout's sources.
#include "axis3fSubSampler.h"
#include "filter.h"
#include "kalman_core.h"
#include "mm_flow.h"
#include "mm_tof.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

// The firmware calls this function if one of its assertions fails.
void assertFail(char* what, char* file, int line) {
  fprintf(stderr, "%s:%d: %s\n", file, line, what);
  abort();
}

static const float kDegrees = 57.29577951f;
static const float kGravity = 9.81f;

static kalmanCoreData_t core;
static kalmanCoreParams_t params;
static Axis3fSubSampler_t force_samples;
static Axis3fSubSampler_t rate_samples;
static lpf2pData force_filter[3];
static lpf2pData rate_filter[3];
static bool begun;

void begin(const double start[4]) {
  kalmanCoreDefaultParams(&params);
  params.initialX = (float)start[0];
  params.initialY = (float)start[1];
  params.initialZ = (float)start[2];
  params.initialYaw = (float)start[3];
  axis3fSubSamplerInit(&force_samples, kGravity);
  axis3fSubSamplerInit(&rate_samples, 1.0f / kDegrees);
  for (int i = 0; i < 3; ++i) {
    lpf2pInit(&force_filter[i], 1000, 30);
    lpf2pInit(&rate_filter[i], 1000, 80);
  }
  kalmanCoreInit(&core, &params, 0);
}

// force [m/s2], rate [rad/s]; counts of the flow sensor, new and valid if `flow` is true; distance [m], negative if not
// new. state: position, velocity, roll, pitch, yaw.
void step(unsigned ms, const double force[3], const double rate[3], const double counts[2], bool flow, double distance,
          bool flying, double state[9]) {
  Axis3f g;
  Axis3f deg;
  for (int i = 0; i < 3; ++i) {
    if (!begun) {
      lpf2pReset(&force_filter[i], (float)force[i] / kGravity);
      lpf2pReset(&rate_filter[i], kDegrees * (float)rate[i]);
    }
    g.axis[i] = lpf2pApply(&force_filter[i], (float)force[i] / kGravity);
    deg.axis[i] = lpf2pApply(&rate_filter[i], kDegrees * (float)rate[i]);
  }
  begun = true;
  axis3fSubSamplerAccumulate(&force_samples, &g);
  axis3fSubSamplerAccumulate(&rate_samples, &deg);
  if (ms % 10 == 0) {
    axis3fSubSamplerFinalize(&force_samples);
    axis3fSubSamplerFinalize(&rate_samples);
    kalmanCorePredict(&core, &params, &force_samples.subSample, &rate_samples.subSample, ms, flying);
  }
  kalmanCoreAddProcessNoise(&core, &params, ms);
  if (flow) {
    const flowMeasurement_t measured = {
        .dpixelx = (float)counts[0], .dpixely = (float)counts[1], .stdDevX = 2.0f, .stdDevY = 2.0f, .dt = 0.01f};
    kalmanCoreUpdateWithFlow(&core, &measured, &deg);
  }
  if (distance >= 0.0) {
    tofMeasurement_t measured = {.distance = (float)distance};
    measured.stdDev = 0.0025f * (1.0f + expf(logf(0.2f / 0.0025f) / 1.5f * (measured.distance - 2.5f)));
    kalmanCoreUpdateWithTof(&core, &measured);
  }
  kalmanCoreFinalize(&core);
  state_t out;
  kalmanCoreExternalizeState(&core, &out, &g);
  const double values[9] = {out.position.x,
                            out.position.y,
                            out.position.z,
                            out.velocity.x,
                            out.velocity.y,
                            out.velocity.z,
                            out.attitude.roll / kDegrees,
                            -out.attitude.pitch / kDegrees,
                            out.attitude.yaw / kDegrees};
  for (int i = 0; i < 9; ++i) state[i] = values[i];
}
