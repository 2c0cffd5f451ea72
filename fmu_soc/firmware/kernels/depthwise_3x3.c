// SPDX-License-Identifier: Apache-2.0
// Computes depthwise convolutions with a kernel of 3 x 3. A unit of work is four channels of one or two rows of output
// positions.
//
// First, the core copies the unit's input rows to its buffer. There, a column has one word per channel, with the values
// of up to four rows. Then the core computes each channel's outputs, with three words for each output. Weights and
// numbers of the requantisation stay in registers. With a stride of one row, four input rows give two output rows: the
// lower row uses the same words with weights shifted by one byte.
#include "kernels/requantise.h"
#include "kernels/work.h"

#define ROWS 4
#define WORDS_PER_COLUMN 4  // one for each channel

// Input rows of a unit of work. A row outside the input has step 0 and points to a constant word.
typedef struct {
  const uint8_t* at[ROWS];
  int32_t step[ROWS];
} rows_t;

// Outputs of a channel: `count` positions of two rows, or of one row if `lower` is null.
typedef struct {
  uint8_t* upper;
  uint8_t* lower;
  int32_t count;
  int32_t to_next;  // bytes to the next position
} places_t;

#ifdef __riscv

// Copies columns: transposes the words of four rows (a to d) to the words of four channels.
static inline __attribute__((always_inline)) void turn_columns(const rows_t* rows, int32_t count, uint32_t* to) {
  const uint8_t *a = rows->at[0], *b = rows->at[1], *c = rows->at[2], *d = rows->at[3];
  // Selectors: 0 to 3 are the bytes of the first word, and 4 to 7 are those of the second word.
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
#define LIMIT_AND_STORE(to)                  \
  XPULP_ADDNR("t3", "%[addend]", "%[shift]") \
  XPULP_MAX("t3", "t3", "%[low]") XPULP_MIN("t3", "t3", "%[high]") XPULP_SB_POST_REG("t3", "%[to_next]", "%[" to "]")
#define SUM(k) "mv t3, %[bias]\n\t" XPULP_SDOTUSP_B("t3", "t1", "%[" k "1]") PRODUCTS(k)
// 8 instructions. The addend includes the product of bias and multiplier.
#define NARROW(k, to) \
  XPULP_DOTUSP_B("t3", "t1", "%[" k "1]") PRODUCTS(k) "mul t3, t3, %[multiplier]\n\t" LIMIT_AND_STORE(to)
#define WIDE(k, to) SUM(k) "mulh t3, t3, %[multiplier]\n\t" LIMIT_AND_STORE(to)  // 9 instructions
#define EXACT(k, to)               \
  SUM(k)                           \
  "mulh t4, t3, %[multiplier]\n\t" \
  "mul t3, t3, %[multiplier]\n\t"  \
  "add t3, t3, %[more]\n\t"        \
  "sltu t3, t3, %[more]\n\t"       \
  "add t3, t3, t4\n\t" LIMIT_AND_STORE(to)  // 13 instructions

// The lower position is stored first. For the last of an odd number of rows, the upper position then overwrites it.
#define FILTER(length, outputs)                                                                                    \
  __asm__ volatile(                                                                                                \
      XPULP_LOOP("x0", "%[n]", length) COLUMNS outputs XPULP_LOOP_END                                              \
      : [p] "+r"(columns), [upper] "+r"(upper), [lower] "+r"(lower)                                                \
      : [n] "r"(places->count), [step] "r"(step), [to_next] "r"(places->to_next), [k0] "r"(k[0]), [k1] "r"(k[4]),  \
        [k2] "r"(k[8]), [l0] "r"(k[0] << 8), [l1] "r"(k[4] << 8), [l2] "r"(k[8] << 8), [bias] "r"(group->bias[i]), \
        [multiplier] "r"(group->multiplier[i]), [addend] "r"(addend), [shift] "r"(group->shift[i]),                \
        [more] "r"(lower_addend(group, i, scaling)), [low] "r"(low), [high] "r"(high)                              \
      : "t0", "t1", "t2", "t3", "t4", "memory")

static inline __attribute__((always_inline)) void filter(const layer_t* layer, const layer_group_t* group, int i,
                                                         const uint32_t* columns, const places_t* places, int scaling) {
  const uint32_t* k = (const uint32_t*)(const void*)weights_of(group, scaling) + i;
  const int32_t step = layer->stride_columns * WORDS_PER_COLUMN * 4;
  const int32_t low = layer->low, high = layer->high;
  uint8_t *upper = places->upper, *lower = places->lower;
  const int is_pair = lower != 0;
  const uint32_t of_bias = scaling == SCALING_NARROW ? (uint32_t)group->bias[i] * (uint32_t)group->multiplier[i] : 0;
  const uint32_t addend = (uint32_t)group->addend[i] + of_bias;
  if (scaling == SCALING_NARROW && is_pair) {
    FILTER("19", NARROW("l", "lower") NARROW("k", "upper"));
  } else if (scaling == SCALING_NARROW) {
    FILTER("11", NARROW("k", "upper"));
  } else if (scaling == SCALING_WIDE && is_pair) {
    FILTER("21", WIDE("l", "lower") WIDE("k", "upper"));
  } else if (scaling == SCALING_WIDE) {
    FILTER("12", WIDE("k", "upper"));
  } else if (is_pair) {
    FILTER("29", EXACT("l", "lower") EXACT("k", "upper"));
  } else {
    FILTER("16", EXACT("k", "upper"));
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
  for (int32_t x = 0; x < places->count; ++x, columns += layer->stride_columns * WORDS_PER_COLUMN) {
    if (places->lower != 0) {
      places->lower[x * places->to_next] = filtered(layer, group, i, columns, 1, scaling);
    }
    places->upper[x * places->to_next] = filtered(layer, group, i, columns, 0, scaling);
  }
}

#endif

// Returns the `count` input rows that the output row `y`, or the two rows from `y` on, need. Other rows repeat the last
// needed row.
static rows_t rows_of(const layer_step_t* step, const layer_group_t* group, int32_t y, int32_t count,
                      const uint32_t* outside) {
  const layer_t* layer = step->layer;
  const int32_t top = step->first_row * layer->stride_rows - layer->pad_top;
  rows_t rows;
  for (int i = 0; i < ROWS; ++i) {
    const int32_t row = y * layer->stride_rows + (i < count ? i : count - 1) * layer->step_y;
    const int is_outside = top + row < 0 || top + row >= layer->in_rows;
    rows.at[i] = is_outside ? (const uint8_t*)outside : step->in + row * step->in_pitch + group->in;
    rows.step[i] = is_outside ? 0 : step->in_channels;
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
  const int32_t units = is_pair ? (step->rows + 1) / 2 : step->rows;
  const int32_t pitch = layer->out_columns * step->channels;
  // The buffer contains a constant word and the columns. Columns outside the input are filled only once.
  uint32_t* outside = (uint32_t*)(void*)step->gathered;
  uint32_t* columns = outside + 1;
  uint32_t* inside = columns + layer->outside_left * WORDS_PER_COLUMN;
  *outside = layer->outside * UINT32_C(0x01010101);
  fill_columns(columns, layer->outside_left, *outside);
  fill_columns(inside + layer->in_columns * WORDS_PER_COLUMN, layer->outside_right, *outside);
  for (int32_t unit = share.core; unit < step->groups * units; unit += share.cores) {
    const int32_t number = unit / units;
    const int32_t y = (unit - number * units) * (1 + is_pair);
    const layer_group_t* group = (const layer_group_t*)(const void*)(step->data + number * layer->group_bytes);
    const int has_lower = is_pair && y + 1 < step->rows;
    const rows_t rows = rows_of(step, group, y, 3 + has_lower, outside);
    turn_columns(&rows, layer->in_columns, inside);
    uint8_t* to = step->out + y * pitch + group->out;
    places_t places = {to, is_pair ? to + has_lower * pitch : 0, layer->out_columns, step->channels};
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
