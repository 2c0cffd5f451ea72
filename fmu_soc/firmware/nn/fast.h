// SPDX-License-Identifier: Apache-2.0
// The network with Xpulp instructions, split over any number of cores that share a memory. Every core calls the same
// function with its own number, and all wait for each other before the next one. Same results as nn_plain_infer.
#pragma once

#include "nn/network.h"

#ifdef __cplusplus
extern "C" {
#endif

// The picture with its border of zeros: 2 above and to the left, 1 below, 2 to the right.
#define NN_PICTURE_PITCH (SHRUNK_EDGE + 4)
#define NN_PICTURE_ROWS (SHRUNK_EDGE + 3)
// Tensors with a border of one place around; one place more at the end, where a pair of places reaches beyond it.
#define NN_BORDERED(edge, channels) (((edge) + 2) * ((edge) + 2) * (channels) + 2 * (channels))

// First layer's weights as its kernel takes them. For each channel four weights of each of the five rows, the fifth
// weights of the first four rows, the fifth weight of the last row.
#define NN_FIRST_WORDS 7

// Bytes of the weights of layers 1 to 7.
#define NN_BYTES_1 (9 * NN_CHANNELS_FIRST * NN_CHANNELS_SECOND)
#define NN_BYTES_2 (9 * NN_CHANNELS_SECOND * NN_CHANNELS_SECOND)
#define NN_BYTES_3 (9 * NN_CHANNELS_SECOND * NN_CHANNELS_THIRD)
#define NN_BYTES_4 (9 * NN_CHANNELS_THIRD * NN_CHANNELS_THIRD)
#define NN_BYTES_5 (9 * NN_CHANNELS_THIRD * NN_CHANNELS_FOURTH)
#define NN_BYTES_6 (9 * NN_CHANNELS_FOURTH * NN_CHANNELS_FOURTH)
#define NN_BYTES_7 (NN_OUTPUTS * NN_FEATURES)

// Weights of the first four layers, as the kernels take them.
typedef struct {
  uint32_t first[NN_CHANNELS_FIRST * NN_FIRST_WORDS];
  uint32_t others[(NN_BYTES_1 + NN_BYTES_2 + NN_BYTES_3) / 4];
} nn_small_weights_t;

// The camera's rows that eight rows of the picture are made of.
#define NN_STRIPE_ROWS 8
#define NN_STRIPE_BYTES (18 * 324)
#define NN_STRIPES (SHRUNK_EDGE / NN_STRIPE_ROWS)

// Whether more must share its place than in the navigator's arena, so that L1 is enough.
#define NN_SHARES_PLACES (NN_CHANNELS_FIRST > 4)

// Everything an inference works on, in the cores' shared memory. What is not needed at the same time shares its place:
// the large weights come where the picture was, the later layers' outputs where the camera's rows were. With
// NN_SHARES_PLACES the first layer's output comes where the camera's rows were, the next two beside the large weights.
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
  int32_t partial_sums[8 * NN_OUTPUTS];  // of the dense layer: for each output, one for each core
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
  int32_t partial_sums[8 * NN_OUTPUTS];  // of the dense layer: for each output, one for each core
} nn_arena_t;
#endif

// Who does a part of the work.
typedef struct {
  unsigned core;
  unsigned cores;  // 1..8
} nn_share_t;

// Once: makes the small weights that the arena needs before the first layer.
void nn_fast_make_small_weights(nn_small_weights_t* small);

// Before each picture: zeros into the borders of the picture and of the first layer's output.
void nn_fast_clear_first(nn_arena_t* arena, nn_share_t share);
// After the picture is made: zeros into the borders of the later layers' outputs.
void nn_fast_clear_later(nn_arena_t* arena, nn_share_t share);
// With NN_SHARES_PLACES, clear_first leaves out the first layer's output, which clear_later clears, so that all must
// wait before the first layer. After it this clears the second's and third's, after which all wait again.
#if NN_SHARES_PLACES
void nn_fast_clear_middle(nn_arena_t* arena, nn_share_t share);
#endif

// Rows `first` to `first + count - 1` of the picture from the camera's rows, of which `source` is the first one needed;
// the camera's pictures are `width` x `height`.
void nn_fast_shrink(nn_arena_t* arena, const uint8_t* source, int width, int height, const uint16_t* columns, int first,
                    int count, nn_share_t share);
// First layer with its pooling.
void nn_fast_first(nn_arena_t* arena, nn_share_t share);
// Layers 1 to 6. From layer 4 on the large weights must be in the arena: see nn_fast_large_weights.
void nn_fast_convolution(nn_arena_t* arena, int layer, nn_share_t share);
// The dense layer, in two steps: every core's part, then by one core the output of the network.
void nn_fast_dense(nn_arena_t* arena, nn_share_t share);
nn_output_t nn_fast_output(const nn_arena_t* arena, unsigned cores);

// Where layers 4 to 7 have their weights in the file, and in the arena: words to move before layer 4.
typedef struct {
  const void* from;
  void* to;
  int bytes;
} nn_move_t;
nn_move_t nn_fast_large_weights(nn_arena_t* arena, int layer);

// The whole network on the core that calls, alone, for a picture that lies in the arena; clears all borders itself.
nn_output_t nn_fast_infer_alone(nn_arena_t* arena, const nn_small_weights_t* small);

// Hash of layer 0 to 6's output without its border, as nn_checksum of the plain one.
uint32_t nn_fast_checksum(const nn_arena_t* arena, int layer);

#ifdef __cplusplus
}
#endif
