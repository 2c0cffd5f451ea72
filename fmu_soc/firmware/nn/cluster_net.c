// SPDX-License-Identifier: Apache-2.0
#include "nn/cluster_net.h"

#include <stddef.h>

#include "nn/fast.h"
#include "runtime/cluster.h"

// Selects the kernels that reduce the picture and compute the first layer. The versions scheduled by hand compute the
// same bytes in fewer cycles.
#ifdef NN_BY_HAND
#include "nn/hand.h"
#define SHRINK nn_hand_shrink
#define FIRST nn_hand_first
#else
#define SHRINK nn_fast_shrink
#define FIRST nn_fast_first
#endif

typedef struct {
  const uint8_t* frame;  // null: the picture is already in the arena
  int width;
  int height;
  unsigned cores;
  nn_output_t output;
} job_t;

static nn_arena_t arena CLUSTER_L1;
static uint16_t columns[SHRUNK_EDGE] CLUSTER_L1;

static nn_small_weights_t small_weights;
static job_t job;

void nn_cluster_init(void) {
  nn_fast_make_small_weights(&small_weights);
}

// Starts to copy the camera's rows for a stripe, and returns the number of the copy.
static uint32_t fetch(const job_t* j, int stripe) {
  const int first = shrink_place(stripe * NN_STRIPE_ROWS, j->height);
  const int last = shrink_place(stripe * NN_STRIPE_ROWS + NN_STRIPE_ROWS - 1, j->height) + 1;
  return dma_copy_in(arena.stripes[stripe & 1], j->frame + first * j->width, (uint32_t)((last - first + 1) * j->width));
}

static void shrink(const job_t* j, nn_share_t share) {
  uint32_t copy = 0;
  if (share.core == 0) {
    copy = fetch(j, 0);
    shrink_columns(j->width, columns);
  }
  for (int stripe = 0; stripe < NN_STRIPES; ++stripe) {
    if (share.core == 0) {
      dma_wait(copy);
    }
    // The stripe has arrived, and all cores have finished the previous stripe, which the next stripe overwrites.
    cluster_barrier();
    if (share.core == 0 && stripe + 1 < NN_STRIPES) {
      copy = fetch(j, stripe + 1);
    }
    SHRINK(&arena, arena.stripes[stripe & 1], j->width, j->height, columns, stripe * NN_STRIPE_ROWS, NN_STRIPE_ROWS,
           share);
  }
}

static void work(void* argument) {
  job_t* j = argument;
  const nn_share_t share = {cluster_core_id(), j->cores};
  uint32_t copies[4] = {0};
  if (share.core == 0) {
    copies[0] = dma_copy_in(&arena.small, &small_weights, sizeof(small_weights));
  }
  nn_fast_clear_first(&arena, share);
  if (j->frame != NULL) {
    shrink(j, share);
  }
  if (share.core == 0) {
    dma_wait(copies[0]);
  }
  cluster_barrier();
  nn_fast_clear_later(&arena, share);
#if NN_SHARES_PLACES
  cluster_barrier();
#endif
  FIRST(&arena, share);
  cluster_barrier();
#if NN_SHARES_PLACES
  nn_fast_clear_middle(&arena, share);
  cluster_barrier();
#endif
  if (share.core == 0) {
    for (int i = 0; i < 4; ++i) {
      const nn_move_t move = nn_fast_large_weights(&arena, 4 + i);
      copies[i] = dma_copy_in(move.to, move.from, (uint32_t)move.bytes);
    }
  }
  for (int layer = 1; layer < NN_CONVOLUTIONS; ++layer) {
    if (share.core == 0 && layer == 4) {
      for (int i = 0; i < 4; ++i) {
        dma_wait(copies[i]);
      }
    }
    if (layer > 1) {
      cluster_barrier();
    }
    nn_fast_convolution(&arena, layer, share);
  }
  cluster_barrier();
  nn_fast_dense(&arena, share);
  cluster_barrier();
  if (share.core == 0) {
    j->output = nn_fast_output(&arena, j->cores);
  }
}

static nn_output_t run(const uint8_t* frame, int width, int height, unsigned cores) {
  const job_t wanted = {frame, width, height, cores, NN_NO_OUTPUT};
  job = wanted;
  cluster_fork(work, cores, &job);
  cluster_wait();
  return *(volatile nn_output_t*)&job.output;
}

nn_output_t nn_cluster_infer(const uint8_t* frame, int width, int height, unsigned cores) {
  return run(frame, width, height, cores);
}

nn_output_t nn_cluster_infer_shrunk(const int8_t picture[NN_PICTURE_BYTES], unsigned cores) {
  for (int y = 0; y < SHRUNK_EDGE; ++y) {
    for (int x = 0; x < SHRUNK_EDGE; ++x) {
      arena.picture[(y + 2) * NN_PICTURE_PITCH + 2 + x] = picture[y * SHRUNK_EDGE + x];
    }
  }
  return run(NULL, 0, 0, cores);
}

uint32_t nn_cluster_checksum(int layer) {
  return nn_fast_checksum(&arena, layer);
}
