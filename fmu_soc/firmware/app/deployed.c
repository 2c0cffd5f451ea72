// SPDX-License-Identifier: Apache-2.0
#include "app/deployed.h"

#include "network.h"
#include "output_order.h"
#include "runtime/cluster.h"
#include "runtime/xpulp.h"

#if NETWORK_CHANNELS != 1
#error "the camera's pictures are grey; the network needs colours"
#endif

// Width of the widest camera picture [px].
#define MOST_COLUMNS 324
#define CORES 8
#define SOURCE_BYTES (2 * MOST_COLUMNS)
#define STRIPES ((NETWORK_ROWS + CORES - 1) / CORES)

// Buffers in L1. Each buffer exists twice: while the cores work on one stripe, the DMA transfers another stripe.
typedef struct {
  uint8_t source[2][CORES][SOURCE_BYTES];  // two rows of the camera's picture for each row of the stripe
  uint8_t rows[2][CORES][NETWORK_COLUMNS];
  uint16_t columns[NETWORK_COLUMNS];  // first source column of each column of the reduced picture
} buffers_t;

_Static_assert(sizeof(buffers_t) <= NETWORK_L1_BYTES, "the rows of the picture do not fit into L1");

static uint8_t picture[NETWORK_PICTURE_BYTES] __attribute__((aligned(4), section(".noinit.picture")));

typedef struct {
  const uint8_t* frame;
  int width;
  int height;
} job_t;

static job_t job;

// Returns the first of the two source rows (or columns) that are averaged for row (or column) `index` of `count`. The
// `length` source rows (or columns) are sampled evenly from edge to edge.
static int place_of(int index, int count, int length) {
  return count < 2 ? (length - 2) / 2 : index * (length - 2) / (count - 1);
}

static int rows_of(int stripe) {
  const int rows = NETWORK_ROWS - stripe * CORES;
  return rows < CORES ? rows : CORES;
}

static void fetch(const job_t* j, buffers_t* buffers, int stripe, uint32_t copies[CORES]) {
  for (int i = 0; i < rows_of(stripe); ++i) {
    const uint8_t* from = j->frame + place_of(stripe * CORES + i, NETWORK_ROWS, j->height) * j->width;
    copies[i] = dma_copy_in(buffers->source[stripe & 1][i], from, (uint32_t)(2 * j->width));
  }
}

static uint32_t store_rows(buffers_t* buffers, int stripe) {
  return dma_copy_out(&picture[stripe * CORES * NETWORK_COLUMNS], buffers->rows[stripe & 1],
                      (uint32_t)(rows_of(stripe) * NETWORK_COLUMNS));
}

// Computes one row of the reduced picture. Each pixel is the rounded mean of 2 x 2 source pixels.
static void reduce_row(const uint8_t* upper, int width, const uint16_t* columns, uint8_t* to) {
  const uint8_t* lower = upper + width;
#pragma GCC unroll 4
  for (int x = 0; x < NETWORK_COLUMNS; ++x) {
    const int at = columns[x];
    const uint32_t above = *(const xpulp_half*)(const void*)(upper + at);
    const uint32_t below = *(const xpulp_half*)(const void*)(lower + at);
    to[x] = (uint8_t)(xpulp_sdotup_b(2, xpulp_pack(above, below), 0x01010101) >> 2);
  }
}

static void reduce(void* argument) {
  const job_t* j = argument;
  buffers_t* buffers = (buffers_t*)(void*)network_l1_buffer();
  const int core = (int)cluster_core_id();
  uint32_t copies[CORES];
  uint32_t stored = DMA_REFUSED;
  for (int x = core; x < NETWORK_COLUMNS; x += CORES) {
    buffers->columns[x] = (uint16_t)place_of(x, NETWORK_COLUMNS, j->width);
  }
  if (core == 0) {
    fetch(j, buffers, 0, copies);
  }
  for (int stripe = 0; stripe < STRIPES; ++stripe) {
    if (core == 0) {
      for (int i = 0; i < rows_of(stripe); ++i) {
        dma_wait(copies[i]);
      }
      dma_wait(stored);
      stored = DMA_REFUSED;
    }
    // The stripe has arrived, and all cores have finished the previous stripe.
    cluster_barrier();
    if (core == 0) {
      if (stripe > 0) {
        stored = store_rows(buffers, stripe - 1);
      }
      if (stripe + 1 < STRIPES) {
        fetch(j, buffers, stripe + 1, copies);
      }
    }
    if (core < rows_of(stripe)) {
      reduce_row(buffers->source[stripe & 1][core], j->width, buffers->columns, buffers->rows[stripe & 1][core]);
    }
  }
  cluster_barrier();
  if (core == 0) {
    dma_wait(stored);
    dma_wait(store_rows(buffers, STRIPES - 1));
  }
}

bool deployed_look(const uint8_t* frame, int width, int height, int8_t* values, int count) {
  static const uint8_t order[] = {OUTPUT_ORDER};
  static network_result_t result;
  if (width < NETWORK_COLUMNS || height < NETWORK_ROWS || width > MOST_COLUMNS || cluster_on() != 0) {
    return false;
  }
  const job_t wanted = {frame, width, height};
  job = wanted;
  bool done = cluster_core_count() == CORES && cluster_fork(reduce, CORES, &job) == 0;
  if (done) {
    cluster_wait();
    done = network_run(picture, &result) == 0;
  }
  cluster_off();
  for (int i = 0; done && i < count; ++i) {
    const int32_t value = network_in_127ths(&result, order[i]);
    values[i] = (int8_t)(value < -127 ? -127 : value > 127 ? 127 : value);
  }
  return done;
}
