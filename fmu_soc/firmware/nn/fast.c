// SPDX-License-Identifier: Apache-2.0
#include "nn/fast.h"

#include <stddef.h>

#include "kernels/dot.h"

typedef uint32_t __attribute__((may_alias)) word_t;

// --- Layout ---------------------------------------------------------------------------------------------------------

static uint8_t* output_of(nn_arena_t* a, int layer) {
  switch (layer) {
    case 0:
      return a->pooled;
    case 1:
      return a->second;
    case 2:
      return a->third;
    case 3:
      return a->fourth;
    case 4:
      return a->fifth;
    case 5:
      return a->sixth;
    default:
      return a->seventh;
  }
}

// Returns the edge of a layer's output. The output of the last convolution has no border, because the dense layer uses
// this output directly.
static int edge_of(int layer) {
  return layer == 0 ? NN_POOLED_EDGE : nn_shapes[layer].out_edge;
}
static int border_of(int layer) {
  return layer == NN_CONVOLUTIONS - 1 ? 0 : 1;
}

// Positions of the weights [words]: of layers 1 to 3 in the small weights, and of layers 4 to 7 in the large weights.
static const uint16_t kSmall[] = {0, 0, NN_BYTES_1 / 4, (NN_BYTES_1 + NN_BYTES_2) / 4};
static const uint16_t kLarge[] = {0, NN_BYTES_4 / 4, (NN_BYTES_4 + NN_BYTES_5) / 4,
                                  (NN_BYTES_4 + NN_BYTES_5 + NN_BYTES_6) / 4};

static const word_t* weights_of(const nn_arena_t* a, int layer) {
  return layer < 4 ? &a->small.others[kSmall[layer]] : &a->weights[kLarge[layer - 4]];
}

static int weight_bytes(int layer) {
  if (layer == NN_CONVOLUTIONS) {
    return NN_BYTES_7;
  }
  const nn_shape_t* shape = &nn_shapes[layer];
  return shape->out_channels * shape->kernel * shape->kernel * shape->in_channels;
}

nn_move_t nn_fast_large_weights(nn_arena_t* arena, int layer) {
  const nn_move_t move = {nn_layer(layer).weights, (void*)weights_of(arena, layer), weight_bytes(layer)};
  return move;
}

static void copy_words(word_t* to, const word_t* from, int bytes) {
  for (int i = 0; i < bytes / 4; ++i) {
    to[i] = from[i];
  }
}

static void clear_words(void* first, const void* end, nn_share_t share) {
  for (word_t* at = (word_t*)first + share.core; at < (const word_t*)end; at += share.cores) {
    *at = 0;
  }
}

void nn_fast_clear_first(nn_arena_t* arena, nn_share_t share) {
#if !NN_SHARES_PLACES
  clear_words(arena->pooled, arena->stripes, share);
#endif
  for (int y = (int)share.core; y < NN_PICTURE_ROWS; y += (int)share.cores) {
    int8_t* row = &arena->picture[y * NN_PICTURE_PITCH];
    if (y < 2 || y >= SHRUNK_EDGE + 2) {
      const nn_share_t all = {0, 1};
      clear_words(row, row + NN_PICTURE_PITCH, all);
    } else {
      *(xpulp_half*)(void*)row = 0;
      *(xpulp_half*)(void*)(row + NN_PICTURE_PITCH - 2) = 0;
    }
  }
}

void nn_fast_clear_later(nn_arena_t* arena, nn_share_t share) {
#if NN_SHARES_PLACES
  clear_words(arena->pooled, arena->seventh, share);
#else
  clear_words(arena->second, arena->seventh, share);
#endif
}

#if NN_SHARES_PLACES
void nn_fast_clear_middle(nn_arena_t* arena, nn_share_t share) {
  clear_words(arena->second, arena->third + sizeof(arena->third), share);
}
#endif

void nn_fast_make_small_weights(nn_small_weights_t* small) {
  const uint8_t* from = (const uint8_t*)nn_layer(0).weights;
  for (int c = 0; c < NN_CHANNELS_FIRST; ++c, from += 25) {
    uint32_t* to = &small->first[c * NN_FIRST_WORDS];
    to[5] = 0;
    for (int row = 0; row < 5; ++row) {
      const uint8_t* w = from + 5 * row;
      to[row] = w[0] | (uint32_t)w[1] << 8 | (uint32_t)w[2] << 16 | (uint32_t)w[3] << 24;
      if (row < 4) {
        to[5] |= (uint32_t)w[4] << (8 * row);
      }
    }
    to[6] = from[24];
  }
  for (int layer = 1; layer < 4; ++layer) {
    copy_words(&small->others[kSmall[layer]], (const word_t*)(const void*)nn_layer(layer).weights, weight_bytes(layer));
  }
}

uint32_t nn_fast_checksum(const nn_arena_t* arena, int layer) {
  const int edge = edge_of(layer);
  const int border = border_of(layer);
  const int channels = nn_shapes[layer].out_channels;
  const int pitch = (edge + 2 * border) * channels;
  const uint8_t* at = output_of((nn_arena_t*)arena, layer) + border * (pitch + channels);
  uint32_t hash = NN_CHECKSUM_START;
  for (int y = 0; y < edge; ++y, at += pitch) {
    hash = nn_checksum(at, edge * channels, hash);
  }
  return hash;
}

// --- Picture --------------------------------------------------------------------------------------------------------

void nn_fast_shrink(nn_arena_t* arena, const uint8_t* source, int width, int height, const uint16_t* columns, int first,
                    int count, nn_share_t share) {
  const int top = shrink_place(first, height);
  for (int y = first + (int)share.core; y < first + count; y += (int)share.cores) {
    const uint8_t* upper = source + (shrink_place(y, height) - top) * width;
    const uint8_t* lower = upper + width;
    const uint16_t* column = columns;
    int8_t* to = &arena->picture[(y + 2) * NN_PICTURE_PITCH + 2];
    const uint32_t ones = 0x01010101;
    // Sum of four pixels, plus 2 for rounding, minus 4 x 128.
#pragma GCC unroll 8
    for (int x = 0; x < SHRUNK_EDGE; ++x) {
      const ptrdiff_t at = *column++;
      const uint32_t above = *(const xpulp_half*)(upper + at);
      const uint32_t below = *(const xpulp_half*)(lower + at);
      *to++ = (int8_t)(xpulp_sdotup_b(2 - 4 * 128, xpulp_pack(above, below), ones) >> 2);
    }
  }
}

// --- First layer: 5 x 5 with stride 2, then the maximum of 2 x 2 -----------------------------------------------------
//
// The four output positions of a pool share a patch of 7 x 7 pixels: two words of each of seven rows, with one unused
// byte. A position needs five rows of five pixels. The first four pixels of a row are one word. The fifth pixels are
// gathered: those of four rows in one word, and the last pixel alone. So 25 products need seven dot products.

typedef struct {
  uint32_t rows[7];   // first four pixels of each row
  uint32_t fifth[2];  // fifth pixels of rows 0 to 3, and of rows 2 to 5
  // Fifth pixel of row 4, and fifth pixel of row 6, each in the lowest byte of a word. The weights of the other bytes
  // are zero.
  uint32_t last[2];
} patch_t;

// Returns the greater sum of two positions, one above the other.
static inline __attribute__((always_inline)) int32_t upright_pair(const patch_t* p, const word_t* weights,
                                                                  int32_t bias) {
  int32_t upper = bias;
  int32_t lower = bias;
#pragma GCC unroll 5
  for (int row = 0; row < 5; ++row) {
    const uint32_t w = weights[row];
    upper = xpulp_sdotsp_b(upper, p->rows[row], w);
    lower = xpulp_sdotsp_b(lower, p->rows[row + 2], w);
  }
  upper = xpulp_sdotsp_b(upper, p->fifth[0], weights[5]);
  lower = xpulp_sdotsp_b(lower, p->fifth[1], weights[5]);
  upper = xpulp_sdotsp_b(upper, p->last[0], weights[6]);
  lower = xpulp_sdotsp_b(lower, p->last[1], weights[6]);
  return xpulp_max(upper, lower);
}

static inline __attribute__((always_inline)) void gather_fifth(patch_t* p, const uint32_t* right) {
  p->fifth[0] = xpulp_packhi_b(xpulp_packlo_b(0, right[1], right[0]), right[3], right[2]);
  p->fifth[1] = xpulp_packhi_b(xpulp_packlo_b(0, right[3], right[2]), right[5], right[4]);
  p->last[0] = right[4];
  p->last[1] = right[6];
}

static inline __attribute__((always_inline)) int32_t to_byte(int32_t sum, int32_t shift) {
  return xpulp_clipur(sum >> shift, 255);
}

// Computes four channels, starting with `from`. A network with four channels needs no loop.
#if NN_CHANNELS_FIRST == 4
#define FIRST_FROM 0
void nn_fast_first(nn_arena_t* arena, nn_share_t share) {
#else
#define FIRST_FROM from
static void first_four(nn_arena_t* arena, nn_share_t share, int from) {
#endif
  nn_layer_t layer = nn_layer(0);
  layer.biases += FIRST_FROM;
  layer.shifts += FIRST_FROM;
  const int32_t b0 = layer.biases[0], b1 = layer.biases[1], b2 = layer.biases[2], b3 = layer.biases[3];
  const int32_t s0 = layer.shifts[0], s1 = layer.shifts[1], s2 = layer.shifts[2], s3 = layer.shifts[3];
  const word_t* const weights = arena->small.first + FIRST_FROM * NN_FIRST_WORDS;
  // A unit of work is half a row. With whole rows, only two of eight cores would compute the last two of the 42 rows.
  const int parts = 2 * NN_POOLED_EDGE;
  for (int part = (int)share.core; part < parts; part += (int)share.cores) {
    const int y = part / 2;
    const int x = part % 2 * (NN_POOLED_EDGE / 2);
    const word_t* at = (const word_t*)(const void*)&arena->picture[4 * y * NN_PICTURE_PITCH + 4 * x];
    word_t* to =
        (word_t*)(void*)&arena->pooled[((y + 1) * (NN_POOLED_EDGE + 2) + x + 1) * NN_CHANNELS_FIRST + FIRST_FROM];
    for (int i = 0; i < NN_POOLED_EDGE / 2; ++i, ++at, to += NN_CHANNELS_FIRST / 4) {
      patch_t p;
      uint32_t right[7];
#pragma GCC unroll 7
      for (int row = 0; row < 7; ++row) {
        p.rows[row] = at[row * NN_PICTURE_PITCH / 4];
        right[row] = at[row * NN_PICTURE_PITCH / 4 + 1];
      }
      gather_fifth(&p, right);
      int32_t m0 = upright_pair(&p, weights, b0);
      int32_t m1 = upright_pair(&p, weights + NN_FIRST_WORDS, b1);
      int32_t m2 = upright_pair(&p, weights + 2 * NN_FIRST_WORDS, b2);
      int32_t m3 = upright_pair(&p, weights + 3 * NN_FIRST_WORDS, b3);
      // The patches of the right positions start two pixels farther to the right.
#pragma GCC unroll 7
      for (int row = 0; row < 7; ++row) {
        right[row] = at[row * NN_PICTURE_PITCH / 4 + 1];
        p.rows[row] = xpulp_shuffle2_h(p.rows[row], right[row], 0x00020001);
        right[row] >>= 16;
      }
      gather_fifth(&p, right);
      m0 = xpulp_max(m0, upright_pair(&p, weights, b0));
      m1 = xpulp_max(m1, upright_pair(&p, weights + NN_FIRST_WORDS, b1));
      m2 = xpulp_max(m2, upright_pair(&p, weights + 2 * NN_FIRST_WORDS, b2));
      m3 = xpulp_max(m3, upright_pair(&p, weights + 3 * NN_FIRST_WORDS, b3));
      *to = pack_bytes(to_byte(m0, s0), to_byte(m1, s1), to_byte(m2, s2), to_byte(m3, s3));
    }
  }
}

#if NN_CHANNELS_FIRST > 4
void nn_fast_first(nn_arena_t* arena, nn_share_t share) {
  for (int from = 0; from < NN_CHANNELS_FIRST; from += 4) {
    first_four(arena, share, from);
  }
}
#endif

// --- Layers 1 to 6: 3 x 3 -------------------------------------------------------------------------------------------
//
// Computes two adjacent output positions for four output channels at a time: six loads provide the operands of eight
// dot products of four products each. Each row of a patch is contiguous in memory, like the row's weights.

typedef struct {
  int words;          // words in a row of a patch
  int to_next_row;    // bytes from the end of a row of a patch to the start of the next row
  int to_next_place;  // bytes from the patch of a position to the patch of the adjacent position
  int channel_bytes;  // bytes of the weights of an output channel
  int out_channels;
} geometry_t;

static void pair_of_places(const uint8_t* patch, const geometry_t* g, const int8_t* weights, const int32_t* biases,
                           const uint8_t* shifts, uint8_t* to, int is_pair) {
  const uint8_t* p0 = patch;
  const uint8_t* p1 = patch + g->to_next_place;
  const int8_t* w0 = weights;
  const int8_t* w1 = w0 + g->channel_bytes;
  const int8_t* w2 = w1 + g->channel_bytes;
  const int8_t* w3 = w2 + g->channel_bytes;
  int32_t a0 = biases[0], a1 = biases[1], a2 = biases[2], a3 = biases[3];
  int32_t b0 = a0, b1 = a1, b2 = a2, b3 = a3;
  const int words = g->words;
  const int to_next_row = g->to_next_row;
  ROW_OF_PATCH;
  p0 += to_next_row;
  p1 += to_next_row;
  ROW_OF_PATCH;
  p0 += to_next_row;
  p1 += to_next_row;
  ROW_OF_PATCH;
  const int32_t s0 = shifts[0], s1 = shifts[1], s2 = shifts[2], s3 = shifts[3];
  *(word_t*)(void*)to = pack_bytes(to_byte(a0, s0), to_byte(a1, s1), to_byte(a2, s2), to_byte(a3, s3));
  if (is_pair) {
    *(word_t*)(void*)(to + g->out_channels) =
        pack_bytes(to_byte(b0, s0), to_byte(b1, s1), to_byte(b2, s2), to_byte(b3, s3));
  }
}

void nn_fast_convolution(nn_arena_t* arena, int index, nn_share_t share) {
  const nn_shape_t* shape = &nn_shapes[index];
  const nn_layer_t layer = nn_layer(index);
  const int8_t* weights = (const int8_t*)weights_of(arena, index);
  const uint8_t* in = output_of(arena, index - 1);
  const int border = border_of(index);
  const int edge = shape->out_edge;
  const int channels = shape->in_channels;
  const int in_pitch = (edge_of(index - 1) + 2) * channels;
  const int out_channels = shape->out_channels;
  const int out_pitch = (edge + 2 * border) * out_channels;
  uint8_t* out = output_of(arena, index) + border * (out_pitch + out_channels);
  const geometry_t g = {3 * channels / 4, in_pitch - 3 * channels, shape->stride * channels, 9 * channels,
                        out_channels};
  // A unit of work is four output channels of one row of output positions.
  const int groups = out_channels / 4;
  for (int unit = (int)share.core; unit < groups * edge; unit += (int)share.cores) {
    const int group = unit % groups;
    const int y = unit / groups;
    const uint8_t* patch = in + y * shape->stride * in_pitch;
    uint8_t* to = out + y * out_pitch + 4 * group;
    for (int x = 0; x < edge; x += 2, patch += 2 * g.to_next_place, to += 2 * out_channels) {
      pair_of_places(patch, &g, weights + 4 * group * g.channel_bytes, layer.biases + 4 * group,
                     layer.shifts + 4 * group, to, x + 1 < edge);
    }
  }
}

// --- Dense ----------------------------------------------------------------------------------------------------------

void nn_fast_dense(nn_arena_t* arena, nn_share_t share) {
  const word_t* weights = weights_of(arena, NN_CONVOLUTIONS);
  const word_t* values = (const word_t*)(const void*)arena->seventh;
  for (int o = 0; o < NN_OUTPUTS; ++o, weights += NN_FEATURES / 4) {
    int32_t sum = 0;
    for (unsigned i = share.core; i < NN_FEATURES / 4; i += share.cores) {
      sum = xpulp_sdotusp_b(sum, values[i], weights[i]);
    }
    arena->partial_sums[8 * o + (int)share.core] = sum;
  }
}

nn_output_t nn_fast_output(const nn_arena_t* arena, unsigned cores) {
  const nn_layer_t dense = nn_layer(NN_CONVOLUTIONS);
#if NN_OUTPUTS == 1
  int32_t sum = dense.biases[0];
  for (unsigned i = 0; i < cores; ++i) {
    sum += arena->partial_sums[i];
  }
  const int32_t yaw = sum >> dense.shifts[0];
  return (int8_t)(yaw < -127 ? -127 : yaw > 127 ? 127 : yaw);
#else
  nn_output_t output;
  for (int o = 0; o < NN_OUTPUTS; ++o) {
    int32_t sum = dense.biases[o];
    for (unsigned i = 0; i < cores; ++i) {
      sum += arena->partial_sums[8 * o + (int)i];
    }
    const int32_t value = sum >> dense.shifts[o];
    output.of[o] = (int8_t)(value < -127 ? -127 : value > 127 ? 127 : value);
  }
  return output;
#endif
}

// --- The whole network on one core ----------------------------------------------------------------------------------

nn_output_t nn_fast_infer_alone(nn_arena_t* arena, const nn_small_weights_t* small) {
  const nn_share_t all = {0, 1};
  copy_words((word_t*)&arena->small, (const word_t*)small, sizeof(*small));
  nn_fast_clear_first(arena, all);
  nn_fast_clear_later(arena, all);
  nn_fast_first(arena, all);
#if NN_SHARES_PLACES
  nn_fast_clear_middle(arena, all);
#endif
  for (int layer = 4; layer <= NN_CONVOLUTIONS; ++layer) {
    const nn_move_t move = nn_fast_large_weights(arena, layer);
    copy_words(move.to, move.from, move.bytes);
  }
  for (int layer = 1; layer < NN_CONVOLUTIONS; ++layer) {
    nn_fast_convolution(arena, layer, all);
  }
  nn_fast_dense(arena, all);
  return nn_fast_output(arena, 1);
}
