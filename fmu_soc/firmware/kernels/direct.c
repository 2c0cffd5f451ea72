// SPDX-License-Identifier: Apache-2.0
// Implements operators that access the network's memory directly, instead of tiles (parts of tensors) that are copied
// to L1.
#include "kernels/machine.h"
#include "kernels/work.h"

static void move_inner(const layer_move_t* move, const uint8_t* in, uint8_t* out, const uint8_t* table) {
  const int32_t* n = move->count;
  const int32_t* a = move->in_step;
  const int32_t* b = move->out_step;
  for (int32_t i2 = 0; i2 < n[2]; ++i2) {
    for (int32_t i3 = 0; i3 < n[3]; ++i3) {
      for (int32_t i4 = 0; i4 < n[4]; ++i4) {
        const uint8_t* from = in + i2 * a[2] + i3 * a[3] + i4 * a[4];
        uint8_t* to = out + i2 * b[2] + i3 * b[3] + i4 * b[4];
        for (int32_t i5 = 0; i5 < n[5]; ++i5, from += a[5], to += b[5]) {
          *to = table != 0 ? table[*from] : *from;
        }
      }
    }
  }
}

void layer_move(const layer_move_t* move, const uint8_t* in, uint8_t* out, layer_share_t share) {
  if (move->fill >= 0) {
    for (int32_t i = share.core; i < move->fill_bytes; i += share.cores) {
      out[i] = (uint8_t)move->fill;
    }
    machine_barrier();
  }
  const uint8_t* table = move->table ? (const uint8_t*)(move + 1) : 0;
  const int32_t inner = move->count[1];
  for (int32_t unit = share.core; unit < move->count[0] * inner; unit += share.cores) {
    const int32_t i = unit / inner;
    const int32_t j = unit - i * inner;
    move_inner(move, in + move->in + i * move->in_step[0] + j * move->in_step[1],
               out + move->out + i * move->out_step[0] + j * move->out_step[1], table);
  }
}

void layer_softmax(const layer_t* layer, const uint32_t* powers, const uint8_t* in, uint8_t* out, layer_share_t share) {
  const int32_t n = layer->in_channels;
  for (int32_t row = share.core; row < layer->in_rows * layer->in_columns; row += share.cores) {
    const uint8_t* from = in + row * n;
    int32_t largest = 0;
    for (int32_t i = 0; i < n; ++i) {
      largest = from[i] > largest ? from[i] : largest;
    }
    uint32_t sum = 0;
    for (int32_t i = 0; i < n; ++i) {
      sum += powers[largest - from[i]];
    }
    for (int32_t i = 0; i < n; ++i) {
      const uint32_t value = (powers[largest - from[i]] * 256 + sum / 2) / sum;
      out[row * n + i] = (uint8_t)(value > 255 ? 255 : value);
    }
  }
}
