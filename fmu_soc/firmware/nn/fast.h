// SPDX-License-Identifier: Apache-2.0
// Computes the network with Xpulp instructions, with the same results as nn_plain_infer(). Cores that share a memory
// divide the work: every core calls the same function with its own number. Between two functions, all cores must wait
// for each other.
#pragma once

#include "nn/network.h"

#ifdef __cplusplus
extern "C" {
#endif

// The picture has a border of zeros: 2 above and to the left, 1 below, 2 to the right.
#define NN_PICTURE_PITCH (SHRUNK_EDGE + 4)
#define NN_PICTURE_ROWS (SHRUNK_EDGE + 3)
// A tensor has a border of one position. After the border, there is space for another pair of positions, because
// positions are computed in pairs and the last pair may exceed the border.
#define NN_BORDERED(edge, channels) (((edge) + 2) * ((edge) + 2) * (channels) + 2 * (channels))

// Words per channel in the first layer's weights: four weights of each of the five rows, then the fifth weights of the
// first four rows, then the fifth weight of the last row.
#define NN_FIRST_WORDS 7

// Sizes of the weights of layers 1 to 7 [bytes].
#define NN_BYTES_1 (9 * NN_CHANNELS_FIRST * NN_CHANNELS_SECOND)
#define NN_BYTES_2 (9 * NN_CHANNELS_SECOND * NN_CHANNELS_SECOND)
#define NN_BYTES_3 (9 * NN_CHANNELS_SECOND * NN_CHANNELS_THIRD)
#define NN_BYTES_4 (9 * NN_CHANNELS_THIRD * NN_CHANNELS_THIRD)
#define NN_BYTES_5 (9 * NN_CHANNELS_THIRD * NN_CHANNELS_FOURTH)
#define NN_BYTES_6 (9 * NN_CHANNELS_FOURTH * NN_CHANNELS_FOURTH)
#define NN_BYTES_7 (NN_OUTPUTS * NN_FEATURES)

// Weights of the first four layers, in the order of the kernels.
typedef struct {
  uint32_t first[NN_CHANNELS_FIRST * NN_FIRST_WORDS];
  uint32_t others[(NN_BYTES_1 + NN_BYTES_2 + NN_BYTES_3) / 4];
} nn_small_weights_t;

// A stripe is the camera's rows for eight rows of the picture.
#define NN_STRIPE_ROWS 8
#define NN_STRIPE_BYTES (18 * 324)
#define NN_STRIPES (SHRUNK_EDGE / NN_STRIPE_ROWS)

// True if more tensors share memory than in the navigator network, so that those of the sight network fit in L1.
#define NN_SHARES_PLACES (NN_CHANNELS_FIRST > 4)

// Data of an inference in the memory that the cores share. Data that are not needed at the same time share addresses:
// the weights of layers 4 to 7 (counted from 0) replace the picture. Without NN_SHARES_PLACES, the outputs after the
// first layer replace the camera's rows. With it, the first layer's output replaces the camera's rows, and the outputs
// of the second and third layer replace the picture, too.
#if NN_SHARES_PLACES
typedef struct {
  union {
    int8_t picture[NN_PICTURE_ROWS * NN_PICTURE_PITCH];
    struct {
      uint32_t weights[(NN_BYTES_4 + NN_BYTES_5 + NN_BYTES_6 + NN_BYTES_7) / 4];
      uint8_t second[NN_BORDERED(21, NN_CHANNELS_SECOND)];
      uint8_t third[NN_BORDERED(21, NN_CHANNELS_SECOND)];
    };
  };
  union {
    uint8_t pooled[NN_BORDERED(NN_POOLED_EDGE, NN_CHANNELS_FIRST)];
    uint8_t stripes[2][NN_STRIPE_BYTES];
  };
  uint8_t fourth[NN_BORDERED(11, NN_CHANNELS_THIRD)];
  uint8_t fifth[NN_BORDERED(11, NN_CHANNELS_THIRD)];
  uint8_t sixth[NN_BORDERED(6, NN_CHANNELS_FOURTH)];
  uint8_t seventh[NN_FEATURES];
  nn_small_weights_t small;
  int32_t partial_sums[8 * NN_OUTPUTS];  // dense layer: for each output, one sum for each core
} nn_arena_t;
#else
typedef struct {
  union {
    int8_t picture[NN_PICTURE_ROWS * NN_PICTURE_PITCH];
    uint32_t weights[(NN_BYTES_4 + NN_BYTES_5 + NN_BYTES_6 + NN_BYTES_7) / 4];
  };
  uint8_t pooled[NN_BORDERED(NN_POOLED_EDGE, NN_CHANNELS_FIRST)];
  union {
    struct {
      uint8_t second[NN_BORDERED(21, NN_CHANNELS_SECOND)];
      uint8_t third[NN_BORDERED(21, NN_CHANNELS_SECOND)];
      uint8_t fourth[NN_BORDERED(11, NN_CHANNELS_THIRD)];
      uint8_t fifth[NN_BORDERED(11, NN_CHANNELS_THIRD)];
      uint8_t sixth[NN_BORDERED(6, NN_CHANNELS_FOURTH)];
      uint8_t seventh[NN_FEATURES];
    };
    uint8_t stripes[2][NN_STRIPE_BYTES];
  };
  nn_small_weights_t small;
  int32_t partial_sums[8 * NN_OUTPUTS];  // dense layer: for each output, one sum for each core
} nn_arena_t;
#endif

typedef struct {
  unsigned core;
  unsigned cores;  // 1 to 8
} nn_share_t;

// Computes the weights of the first four layers in the order of the kernels. Must be called once, before the first
// inference.
void nn_fast_make_small_weights(nn_small_weights_t* small);

// Clears the borders of the picture and of the first layer's output. Must be called before each picture.
void nn_fast_clear_first(nn_arena_t* arena, nn_share_t share);
// Clears the borders of the outputs after the first layer. Must be called after the picture is reduced, because these
// outputs replace the camera's rows.
void nn_fast_clear_later(nn_arena_t* arena, nn_share_t share);
// If NN_SHARES_PLACES is 1, nn_fast_clear_later() clears the first layer's output instead of nn_fast_clear_first().
// Therefore all cores must wait before the first layer. After that layer, nn_fast_clear_middle() clears the outputs of
// the second and third layer, and all cores must wait again.
#if NN_SHARES_PLACES
void nn_fast_clear_middle(nn_arena_t* arena, nn_share_t share);
#endif

// Computes rows `first` to `first + count - 1` of the picture from the camera's rows. `source` must be the first camera
// row that is needed. The camera's pictures have `width` x `height` pixels.
void nn_fast_shrink(nn_arena_t* arena, const uint8_t* source, int width, int height, const uint16_t* columns, int first,
                    int count, nn_share_t share);
void nn_fast_first(nn_arena_t* arena, nn_share_t share);
// Computes one of layers 1 to 6. Layers from 4 on need the large weights in the arena: see nn_fast_large_weights().
void nn_fast_convolution(nn_arena_t* arena, int layer, nn_share_t share);
// Compute the dense layer in two steps: every core computes a part of the sums, then one core computes the outputs.
void nn_fast_dense(nn_arena_t* arena, nn_share_t share);
nn_output_t nn_fast_output(const nn_arena_t* arena, unsigned cores);

// A copy of the weights of one layer (4 to 7) from the file to the arena. All copies must end before layer 4.
typedef struct {
  const void* from;
  void* to;
  int bytes;
} nn_move_t;
nn_move_t nn_fast_large_weights(nn_arena_t* arena, int layer);

// Computes the whole network on the calling core, for a picture in the arena.
nn_output_t nn_fast_infer_alone(nn_arena_t* arena, const nn_small_weights_t* small);

// Returns the hash of a layer's output (0 to 6) without its border. The hash is equal to that of the plain code.
uint32_t nn_fast_checksum(const nn_arena_t* arena, int layer);

#ifdef __cplusplus
}
#endif
