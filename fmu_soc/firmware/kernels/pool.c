// SPDX-License-Identifier: Apache-2.0
// Computes the maximum and the mean of the positions in a window, for each channel.
#include "kernels/requantise.h"
#include "kernels/work.h"

typedef struct {
  const uint8_t* in;
  int32_t rows, columns;  // size of the window
  int32_t channels, pitch;
  int32_t first, end;  // channels to compute
} window_t;

static uint8_t largest(const window_t* w, int32_t channel) {
  int32_t result = 0;
  for (int32_t i = 0; i < w->rows; ++i) {
    const uint8_t* at = w->in + i * w->pitch + channel;
    for (int32_t j = 0; j < w->columns; ++j, at += w->channels) {
      result = *at > result ? *at : result;
    }
  }
  return (uint8_t)result;
}

#ifdef __riscv

// Computes the maximum over the window for four channels at a time. Returns the first channel that was not computed.
static inline __attribute__((always_inline)) int32_t largest_of_fours(const window_t* w, uint8_t* to) {
  const int32_t channels = w->channels, pitch = w->pitch, rows = w->rows, columns = w->columns;
  int32_t channel = w->first;
  const uint8_t* in = w->in + channel;
  if (rows == 2 && columns == 2) {
    for (; channel + 4 <= w->end; channel += 4, in += 4) {
      const xpulp_word* upper = (const xpulp_word*)(const void*)in;
      const xpulp_word* lower = (const xpulp_word*)(const void*)(in + pitch);
      const uint32_t left = xpulp_maxu_b(*upper, *lower);
      const uint32_t right = xpulp_maxu_b(*(const xpulp_word*)(const void*)(in + channels),
                                          *(const xpulp_word*)(const void*)(in + pitch + channels));
      *(xpulp_word*)(void*)(to + channel) = xpulp_maxu_b(left, right);
    }
    return channel;
  }
  for (; channel + 4 <= w->end; channel += 4, in += 4) {
    uint32_t result = 0;
    const uint8_t* row = in;
    for (int32_t i = rows; i > 0; --i, row += pitch) {
      const uint8_t* at = row;
      for (int32_t j = columns; j > 0; --j, at += channels) {
        result = xpulp_maxu_b(result, *(const xpulp_word*)(const void*)at);
      }
    }
    *(xpulp_word*)(void*)(to + channel) = result;
  }
  return channel;
}

#else

static int32_t largest_of_fours(const window_t* w, uint8_t* to) {
  (void)to;
  return w->first;
}

#endif

void layer_max_pool(const layer_step_t* step, layer_share_t share) {
  const layer_t* layer = step->layer;
  const int32_t columns = layer->out_columns;
  // A pool that is fused with a convolution has no padding, and its windows do not overlap.
  const int is_fused = layer->then != 0;
  const int32_t stride = is_fused ? layer->pool : layer->stride_columns;
  const int32_t row_stride = is_fused ? layer->pool : layer->stride_rows;
  window_t window = {0};
  window.rows = is_fused ? layer->pool : layer->kernel_rows;
  window.columns = is_fused ? layer->pool : layer->kernel_columns;
  window.channels = is_fused ? step->channels : step->in_channels;
  window.pitch = is_fused ? columns * layer->pool * step->channels : step->in_pitch;
  const uint8_t* in = is_fused ? step->unpooled : step->in;
  // A unit of work is four channels of an output position. Each core computes consecutive units.
  const int32_t fours = (step->channels + 3) / 4;
  const int32_t units = step->rows * columns * fours;
  const range_t range = range_of(units, share);
  int32_t unit = range.begin;
  const int32_t end = range.end;
  const int32_t place = unit / fours;
  int32_t four = unit - place * fours;
  int32_t y = place / columns;
  int32_t x = place - y * columns;
  for (uint8_t* to = step->out + place * step->channels; unit < end; to += step->channels, four = 0) {
    const int32_t last = smaller(fours, four + end - unit);
    window.in = in + y * row_stride * window.pitch + x * stride * window.channels;
    window.first = 4 * four;
    window.end = smaller(4 * last, step->channels);
    for (int32_t channel = largest_of_fours(&window, to); channel < window.end; ++channel) {
      to[channel] = largest(&window, channel);
    }
    unit += last - four;
    if (++x == columns) {
      x = 0;
      ++y;
    }
  }
}

static int32_t inside(int32_t first, int32_t length, int32_t limit) {
  const int32_t begin = first < 0 ? 0 : first;
  const int32_t end = first + length > limit ? limit : first + length;
  return end - begin;
}

void layer_average_pool(const layer_step_t* step, layer_share_t share) {
  const layer_t* layer = step->layer;
  const int32_t columns = layer->out_columns;
  const layer_mean_t* means = (const layer_mean_t*)(const void*)step->data;
  const int32_t base = layer->kernel_rows * layer->kernel_columns * layer->outside;
  // A unit of work is one channel of one output position.
  for (int32_t unit = share.core; unit < step->rows * columns * step->channels; unit += share.cores) {
    const int32_t place = unit / step->channels;
    const int32_t channel = unit - place * step->channels;
    const int32_t y = place / columns;
    const int32_t x = place - y * columns;
    const uint8_t* at =
        step->in + y * layer->stride_rows * step->in_pitch + x * layer->stride_columns * step->in_channels + channel;
    int32_t sum = -base;
    for (int32_t i = 0; i < layer->kernel_rows; ++i, at += step->in_pitch) {
      const uint8_t* value = at;
      for (int32_t j = 0; j < layer->kernel_columns; ++j, value += step->in_channels) {
        sum += *value;
      }
    }
    const layer_mean_t* mean = means;
    if (layer->zeros[0]) {  // the mean excludes positions outside the input
      const int32_t row = (step->first_row + y) * layer->stride_rows - layer->pad_top;
      const int32_t column = x * layer->stride_columns - layer->pad_left;
      mean +=
          inside(row, layer->kernel_rows, layer->in_rows) * inside(column, layer->kernel_columns, layer->in_columns) -
          1;
    }
    const int32_t value = scaled(sum, mean->multiplier, mean->addend, mean->shift, layer->scaling == SCALING_WIDE);
    step->out[unit] = (uint8_t)limited(value, layer->low, layer->high);
  }
}
