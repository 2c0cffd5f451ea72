// SPDX-License-Identifier: Apache-2.0
// Computes depthwise convolutions with a kernel of 3 x 3. A unit of work is four channels of a strip of output rows.
//
// A pass computes one or two output rows. For each pass of the strip, the core first copies the input rows to its
// buffer. There, a column has one word per channel, which contains the values of three or four rows. Then the core
// computes the outputs of each channel. Each output needs three words of the buffer. The weights and the numbers of the
// requantisation stay in registers. With a stride of one row, a pass computes two output rows from four input rows: the
// lower row uses the same words, and weights that are shifted by one byte.
#include "kernels/requantise.h"
#include "kernels/work.h"

#define ROWS 4
#define WORDS_PER_COLUMN 4  // one for each channel

// Input rows of a unit of work. A row outside the input has step 0 and points to a constant word.
typedef struct {
  const uint8_t* at[ROWS];
  int32_t step[ROWS];
} rows_t;

// The outputs of a channel in a strip. Each pass computes `count` positions of the row at `upper` and, unless `lower`
// is null, of the row at `lower`.
typedef struct {
  uint8_t* upper;
  uint8_t* lower;
  int32_t count;
  int32_t to_next;  // bytes to the next position
  int32_t passes;
  int32_t next_pass;  // bytes from the end of a pass's row to the start of the next pass's row
  int32_t columns;    // number of the buffer's columns for each pass
} places_t;

#ifdef __riscv

// Copies columns: transposes the words of four rows (a to d) to the words of four channels.
static inline __attribute__((always_inline)) void turn_columns(const rows_t* rows, int32_t count, uint32_t* to) {
  const uint8_t *a = rows->at[0], *b = rows->at[1], *c = rows->at[2], *d = rows->at[3];
  // In a selector, 0 to 3 are the bytes of the first word, and 4 to 7 are the bytes of the second word.
  __asm__ volatile(
      XPULP_LOOP("x0", "%[n]", "18") XPULP_LW_POST_REG("t0", "%[sa]", "%[a]") XPULP_LW_POST_REG("t1", "%[sb]", "%[b]")
          XPULP_LW_POST_REG("t2", "%[sc]", "%[c]") XPULP_LW_POST_REG("t3", "%[sd]", "%[d]") "mv t4, t0\n\t"
                                                                                            "mv t5, t2\n\t"  //
      XPULP_SHUFFLE2_B("t0", "t1", "%[lower]") XPULP_SHUFFLE2_B("t2", "t3", "%[lower]")                                  //
      XPULP_SHUFFLE2_B("t4", "t1", "%[upper]") XPULP_SHUFFLE2_B("t5", "t3", "%[upper]")                                  //
      XPULP_PACK_H("t1", "t2", "t0") XPULP_SW_POST("t1", "4", "%[to]")                                             //
      XPULP_SHUFFLE2_H("t0", "t2", "%[halves]") XPULP_SW_POST("t0", "4", "%[to]")                                  //
      XPULP_PACK_H("t3", "t5", "t4") XPULP_SW_POST("t3", "4", "%[to]")                                             //
      XPULP_SHUFFLE2_H("t4", "t5", "%[halves]") XPULP_SW_POST("t4", "4", "%[to]")                                  //
      XPULP_LOOP_END
      : [a] "+r"(a), [b] "+r"(b), [c] "+r"(c), [d] "+r"(d), [to] "+r"(to)
      : [n] "r"(count), [sa] "r"(rows->step[0]), [sb] "r"(rows->step[1]), [sc] "r"(rows->step[2]),
        [sd] "r"(rows->step[3]), [lower] "r"(0x05010400), [upper] "r"(0x07030602), [halves] "r"(0x00030001)
      : "t0", "t1", "t2", "t3", "t4", "t5", "memory");
}

// Loads three columns of a channel into t0, t1 and t2.
#define COLUMNS         \
  "lw t1, 16(%[p])\n\t" \
  "lw t2, 32(%[p])\n\t" XPULP_LW_POST_REG("t0", "%[step]", "%[p]")
#define PRODUCTS(k) XPULP_SDOTUSP_B("t3", "t2", "%[" k "2]") XPULP_SDOTUSP_B("t3", "t0", "%[" k "0]")
#define STORE(to) XPULP_SB_POST_REG("t3", "%[to_next]", "%[" to "]")
// Limit a value and store it. FROM_ZERO has one instruction less, but requires that the lower bound is 0.
#define BETWEEN(to) XPULP_MAX("t3", "t3", "%[low]") XPULP_MIN("t3", "t3", "%[high]") STORE(to)
#define FROM_ZERO(to) XPULP_CLIPUR("t3", "t3", "%[high]") STORE(to)
#define SHIFT XPULP_ADDNR("t3", "%[addend]", "%[shift]")
#define SUM(k) "mv t3, %[bias]\n\t" XPULP_SDOTUSP_B("t3", "t1", "%[" k "1]") PRODUCTS(k)
// 5 instructions, none for the bias: the addend includes the product of bias and multiplier.
#define NARROW(k) XPULP_DOTUSP_B("t3", "t1", "%[" k "1]") PRODUCTS(k) "mul t3, t3, %[multiplier]\n\t" SHIFT
#define WIDE(k) SUM(k) "mulh t3, t3, %[multiplier]\n\t" SHIFT  // 6 instructions
#define EXACT(k)                   \
  SUM(k)                           \
  "mulh t4, t3, %[multiplier]\n\t" \
  "mul t3, t3, %[multiplier]\n\t"  \
  "add t3, t3, %[more]\n\t"        \
  "sltu t3, t3, %[more]\n\t"       \
  "add t3, t3, t4\n\t" SHIFT  // 10 instructions

// Computes all passes of a channel. The inner loop computes the positions of a pass and has `length` instructions. The
// outer loop has `body` = `length` + 4 instructions. If a pass has two rows, stores the output of the lower row first.
#define FILTER(length, body, outputs, ...)                                                                             \
  __asm__ volatile(                                                                                                    \
      "lw t0, %[passes]\n\t" XPULP_LOOP("x1", "t0", body) XPULP_LOOP("x0", "%[n]", length)                             \
          COLUMNS outputs XPULP_LOOP_END                                                                               \
      "add %[p], %[p], %[skip]\n\tadd %[upper], %[upper], %[jump]\n\tadd %[lower], %[lower], "                         \
      "%[jump]\n\t" XPULP_LOOP_END                                                                                     \
      : [p] "+r"(columns), [upper] "+r"(upper), [lower] "+r"(lower)                                                    \
      : [n] "r"(places->count), [passes] "m"(places->passes), [step] "r"(step), [skip] "r"(skip),                      \
        [jump] "r"(places->next_pass), [to_next] "r"(places->to_next), [k0] "r"(k[0]), [k1] "r"(k[4]), [k2] "r"(k[8]), \
        [multiplier] "r"(group->multiplier[i]), [addend] "r"(addend), [shift] "r"(group->shift[i]), [high] "r"(high),  \
        __VA_ARGS__                                                                                                    \
      : "t0", "t1", "t2", "t3", "t4", "memory")
#define LOWER_ROW [l0] "r"(k[0] << 8), [l1] "r"(k[4] << 8), [l2] "r"(k[8] << 8)
#define BIAS [bias] "r"(group->bias[i])
#define LEAST [low] "r"(low)
#define MORE [more] "r"(lower_addend(group, i, scaling))
#define ONE(sum, limit) sum("k") limit("upper")
#define TWO(sum, limit) sum("l") limit("lower") sum("k") limit("upper")

static inline __attribute__((always_inline)) void filter(const layer_t* layer, const layer_group_t* group, int i,
                                                         const uint32_t* columns, const places_t* places, int scaling) {
  const uint32_t* k = (const uint32_t*)(const void*)weights_of(group, scaling) + i;
  const int32_t step = layer->stride_columns * WORDS_PER_COLUMN * 4;
  const int32_t skip = places->columns * WORDS_PER_COLUMN * 4 - places->count * step;
  const int32_t low = layer->low, high = layer->high;
  uint8_t *upper = places->upper, *lower = places->lower;
  const int is_pair = lower != 0;
  const uint32_t of_bias = scaling == SCALING_NARROW ? (uint32_t)group->bias[i] * (uint32_t)group->multiplier[i] : 0;
  const uint32_t addend = (uint32_t)group->addend[i] + of_bias;
  if (scaling == SCALING_NARROW && low == 0) {
    if (is_pair) {
      FILTER("17", "21", TWO(NARROW, FROM_ZERO), LOWER_ROW);
    } else {
      FILTER("10", "14", ONE(NARROW, FROM_ZERO), LEAST);
    }
  } else if (scaling == SCALING_NARROW) {
    if (is_pair) {
      FILTER("19", "23", TWO(NARROW, BETWEEN), LOWER_ROW, LEAST);
    } else {
      FILTER("11", "15", ONE(NARROW, BETWEEN), LEAST);
    }
  } else if (scaling == SCALING_WIDE) {
    if (is_pair) {
      FILTER("21", "25", TWO(WIDE, BETWEEN), LOWER_ROW, LEAST, BIAS);
    } else {
      FILTER("12", "16", ONE(WIDE, BETWEEN), LEAST, BIAS);
    }
  } else if (is_pair) {
    FILTER("29", "33", TWO(EXACT, BETWEEN), LOWER_ROW, LEAST, BIAS, MORE);
  } else {
    FILTER("16", "20", ONE(EXACT, BETWEEN), LEAST, BIAS, MORE);
  }
}

#else

static void turn_columns(const rows_t* rows, int32_t count, uint32_t* to) {
  for (int32_t x = 0; x < count; ++x, to += WORDS_PER_COLUMN) {
    for (int i = 0; i < WORDS_PER_COLUMN; ++i) {
      to[i] = 0;
      for (int row = 0; row < ROWS; ++row) {
        to[i] |= (uint32_t)rows->at[row][x * rows->step[row] + i] << 8 * row;
      }
    }
  }
}

static uint8_t filtered(const layer_t* layer, const layer_group_t* group, int i, const uint32_t* columns, int is_lower,
                        int scaling) {
  const int8_t* weights = weights_of(group, scaling) + 4 * i;
  int32_t sum = group->bias[i];
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      sum += (int32_t)(columns[column * WORDS_PER_COLUMN] >> 8 * (row + is_lower) & 0xff) * weights[16 * column + row];
    }
  }
  return (uint8_t)limited(byte_of(group, lower_addend(group, i, scaling), i, sum, scaling), layer->low, layer->high);
}

static void filter(const layer_t* layer, const layer_group_t* group, int i, const uint32_t* columns,
                   const places_t* places, int scaling) {
  uint8_t *upper = places->upper, *lower = places->lower;
  for (int32_t pass = 0; pass < places->passes; ++pass, columns += places->columns * WORDS_PER_COLUMN) {
    const uint32_t* at = columns;
    for (int32_t x = 0; x < places->count; ++x, at += layer->stride_columns * WORDS_PER_COLUMN) {
      if (lower != 0) {
        *lower = filtered(layer, group, i, at, 1, scaling);
        lower += places->to_next;
      }
      *upper = filtered(layer, group, i, at, 0, scaling);
      upper += places->to_next;
    }
    upper += places->next_pass;
    lower += lower != 0 ? places->next_pass : 0;
  }
}

#endif

// Returns the input rows for output row `y` (`count` = 3), or for output rows `y` and `y` + 1 (`count` = 4). The
// remaining elements repeat the last row.
static inline __attribute__((always_inline)) rows_t rows_of(const layer_step_t* step, const layer_group_t* group,
                                                            int32_t y, int32_t count, const uint32_t* outside) {
  const layer_t* layer = step->layer;
  const int32_t top = step->first_row * layer->stride_rows - layer->pad_top;
  int32_t row = y * layer->stride_rows;
  rows_t rows;
#pragma GCC unroll 4
  for (int i = 0; i < ROWS; ++i) {
    const int is_outside = (uint32_t)(top + row) >= (uint32_t)layer->in_rows;
    rows.at[i] = is_outside ? (const uint8_t*)outside : step->in + row * step->in_pitch + group->in;
    rows.step[i] = is_outside ? 0 : step->in_channels;
    row += i + 1 < count ? layer->step_y : 0;
  }
  return rows;
}

static void fill_columns(uint32_t* to, int32_t count, uint32_t value) {
  for (int32_t i = 0; i < count * WORDS_PER_COLUMN; ++i) {
    to[i] = value;
  }
}

static inline __attribute__((always_inline)) void convolve(const layer_step_t* step, layer_share_t share, int scaling) {
  const layer_t* layer = step->layer;
  const int is_pair = layer->stride_rows == 1 && layer->step_y == 1;
  const int32_t each = 1 + is_pair;  // output rows of a pass
  const int32_t passes = (step->rows + is_pair) / each;
  const int32_t strips = (passes + layer->strip - 1) / layer->strip;
  const int32_t pitch = layer->out_columns * step->channels;
  const int32_t width = layer->outside_left + layer->in_columns + layer->outside_right;
  // The core's buffer contains a word for rows outside the input, and the columns of each pass. The columns outside the
  // input are the same for all units of work, so they are written only once.
  uint32_t* outside = (uint32_t*)(void*)step->gathered;
  uint32_t* columns = outside + 1;
  *outside = layer->outside * UINT32_C(0x01010101);
  for (int32_t i = 0; i < smaller(passes, layer->strip); ++i) {
    uint32_t* at = columns + i * width * WORDS_PER_COLUMN;
    fill_columns(at, layer->outside_left, *outside);
    fill_columns(at + (width - layer->outside_right) * WORDS_PER_COLUMN, layer->outside_right, *outside);
  }
  for (int32_t unit = share.core; unit < step->groups * strips; unit += share.cores) {
    const int32_t number = unit / strips;
    const int32_t first = (unit - number * strips) * layer->strip;
    const int32_t count = smaller(layer->strip, passes - first);
    const layer_group_t* group = (const layer_group_t*)(const void*)(step->data + number * layer->group_bytes);
    uint32_t* inside = columns + layer->outside_left * WORDS_PER_COLUMN;
    for (int32_t y = first * each; y < (first + count) * each; y += each, inside += width * WORDS_PER_COLUMN) {
      const rows_t rows = rows_of(step, group, y, is_pair && y + 1 < step->rows ? 4 : 3, outside);
      turn_columns(&rows, layer->in_columns, inside);
    }
    // If passes have two rows, but the number of output rows is odd, the lower row of the last pass is not used.
    uint8_t* to = step->out + first * each * pitch + group->out;
    places_t places = {to,
                       is_pair ? to + pitch : 0,
                       layer->out_columns,
                       step->channels,
                       count,
                       each * pitch - layer->out_columns * step->channels,
                       width};
    for (int i = 0; i < group->count; ++i, ++places.upper, places.lower += is_pair) {
      filter(layer, group, i, columns + i, &places, scaling);
    }
  }
}

#define DEFINE(name, scaling)                                                      \
  void layer_depthwise_3x3_##name(const layer_step_t* step, layer_share_t share) { \
    convolve(step, share, scaling);                                                \
  }

DEFINE(narrow, SCALING_NARROW)
DEFINE(wide, SCALING_WIDE)
DEFINE(exact, SCALING_EXACT)
