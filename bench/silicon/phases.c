// SPDX-License-Identifier: Apache-2.0
// Runs the phases that GreenWaves' benchmark measured with an oscilloscope. Prints a line "begin NAME" before each
// phase, and "end" after it. The fabric controller sleeps in all phases.
#include "kernels.h"

#include "drivers/timer.h"
#include "runtime/cluster.h"
#include "runtime/console.h"
#include "runtime/interrupt.h"

static int8_t pixels[kPixels * kPixels] CLUSTER_L1 __attribute__((aligned(4)));
static int8_t weights[kOutputs * kInputs] CLUSTER_L1 __attribute__((aligned(4)));
static int8_t filter[28] CLUSTER_L1 __attribute__((aligned(4)));
static int8_t filter_by_words[28] CLUSTER_L1 __attribute__((aligned(4)));
static int8_t out[kOut * kOut] CLUSTER_L1 __attribute__((aligned(4)));
static int32_t sums[kOutputs] CLUSTER_L1;

static struct {
  job_t job;
  kernel_t kernel;
  unsigned repeats;
} work;

static void fill(void* argument) {
  (void)argument;
  uint32_t noise = 1;
  for (unsigned i = 0; i < sizeof pixels; ++i) pixels[i] = (int8_t)((noise = noise * 1664525u + 1013904223u) >> 24);
  for (unsigned i = 0; i < sizeof weights; ++i) weights[i] = (int8_t)((noise = noise * 1664525u + 1013904223u) >> 24);
  for (unsigned i = 0; i < sizeof filter; ++i) filter[i] = (int8_t)(i < kTaps ? weights[i] : 0);
  // Stores four columns of each row, then the fifth column.
  for (unsigned row = 0; row < 5; ++row) {
    for (unsigned column = 0; column < 4; ++column) filter_by_words[row * 4 + column] = filter[row * 5 + column];
    filter_by_words[20 + row] = filter[row * 5 + 4];
  }
}

static void run(void* argument) {
  (void)argument;
  for (unsigned i = 0; i < work.repeats; ++i) {
    work.kernel(&work.job, cluster_core_id());
    if (work.job.cores > 1) cluster_barrier();
  }
}

// A hash of all results. It must be equal for all forms of a kernel.
static uint32_t checksum;
static void add_up(void* argument) {
  (void)argument;
  uint32_t sum = 0;
  for (unsigned i = 0; i < sizeof out; ++i) sum = sum * 31 + (uint8_t)out[i];
  for (unsigned i = 0; i < kOutputs; ++i) sum = sum * 31 + (uint32_t)sums[i];
  checksum = sum;
}

static void wipe(void* argument) {
  (void)argument;
  for (unsigned i = 0; i < sizeof out; ++i) out[i] = 0;
  for (unsigned i = 0; i < kOutputs; ++i) sums[i] = 0;
}

static void measure(const char* name, kernel_t kernel, const int8_t* its_weights, unsigned cores, unsigned repeats) {
  work.job = (job_t){pixels, its_weights, sums, out, cores};
  work.kernel = kernel;
  cluster_fork(wipe, 1, 0);
  cluster_wait();
  work.repeats = 1;  // the first run fills the instruction cache
  cluster_fork(run, cores, 0);
  cluster_wait();
  work.repeats = repeats;
  print("begin %s %u %u\n", name, cores, repeats);
  cluster_fork(run, cores, 0);
  cluster_wait();
  print("end\n");
  cluster_fork(add_up, 1, 0);
  cluster_wait();
  print("checksum %s %u %x\n", name, cores, checksum);
}

static void rest(const char* name) {
  print("begin %s 0 1\n", name);
  timer_sleep_until(timer_now_ns() + 2 * NS_PER_MS);
  print("end\n");
}

int main(void) {
  interrupts_off();
  timer_init();
  rest("fc_asleep");
  if (cluster_on() != 0) {
    print("no cluster\n");
    return 1;
  }
  rest("cluster_idle");
  cluster_fork(fill, 1, 0);
  cluster_wait();
  for (unsigned cores = 1; cores <= 8; cores += 7) {
    measure("convolution_plain", convolution_plain, filter, cores, cores);
    measure("convolution_scalar", convolution_scalar, filter, cores, cores);
    measure("convolution_vector", convolution_vector, filter_by_words, cores, 4 * cores);
    measure("linear_plain", linear_plain, weights, cores, 4 * cores);
    measure("linear_scalar", linear_scalar, weights, cores, 8 * cores);
    measure("linear_vector", linear_vector, weights, cores, 16 * cores);
    measure("pool_plain", pool_plain, weights, cores, 8 * cores);
    measure("pool_scalar", pool_scalar, weights, cores, 16 * cores);
    measure("pool_vector", pool_vector, weights, cores, 64 * cores);
    measure("average_scalar", average_scalar, weights, cores, 16 * cores);
    measure("average_vector", average_vector, weights, cores, 16 * cores);
    measure("xnor_plain", xnor_plain, filter, cores, cores);
    measure("xnor_scalar", xnor_scalar, filter, cores, 4 * cores);
  }
  cluster_off();
  return 0;
}
