// SPDX-License-Identifier: Apache-2.0
// Computes convolutions without groups, and dense layers, which are convolutions with one output position. A unit of
// work is four output positions and four channels. Each core computes consecutive units.
#include "kernels/block.h"
#include "kernels/work.h"

// Copies `count` ranges of bytes to contiguous bytes. The last copied words may exceed a range; the next range
// overwrites the extra bytes.
static inline __attribute__((always_inline)) void copy_ranges(uint8_t* to, const uint8_t* from, int32_t count,
                                                              int32_t bytes, int32_t step) {
  for (; count > 0; --count, from += step, to += bytes) {
#ifdef __riscv
    const uint8_t* source = from;
    uint8_t* target = to;
    __asm__ volatile(XPULP_LOOP("x0", "%[n]", "4") "lw t1, 4(%[from])\n\t" XPULP_LW_POST(
                         "t0", "8", "%[from]") "sw t1, 4(%[to])\n\t" XPULP_SW_POST("t0", "8", "%[to]") XPULP_LOOP_END
                     : [from] "+r"(source), [to] "+r"(target)
                     : [n] "r"((bytes + 7) / 8)
                     : "t0", "t1", "memory");
#else
    for (int32_t i = 0; i < bytes; ++i) {
      to[i] = from[i];
    }
#endif
  }
}

#ifdef __riscv

// Load or store one to four words of a row. The first word comes last, because its access moves the pointer to the next
// row.
#define LOAD_1(a, b, c, d, from) XPULP_LW_POST_REG(a, "%[step]", from)
#define LOAD_2(a, b, c, d, from) "lw " b ", 4(" from ")\n\t" LOAD_1(a, b, c, d, from)
#define LOAD_3(a, b, c, d, from) "lw " c ", 8(" from ")\n\t" LOAD_2(a, b, c, d, from)
#define LOAD_4(a, b, c, d, from) "lw " d ", 12(" from ")\n\t" LOAD_3(a, b, c, d, from)
#define STORE_1(a, b, c, d, to) XPULP_SW_POST_REG(a, "%[bytes]", to)
#define STORE_2(a, b, c, d, to) "sw " b ", 4(" to ")\n\t" STORE_1(a, b, c, d, to)
#define STORE_3(a, b, c, d, to) "sw " c ", 8(" to ")\n\t" STORE_2(a, b, c, d, to)
#define STORE_4(a, b, c, d, to) "sw " d ", 12(" to ")\n\t" STORE_3(a, b, c, d, to)
#define COPY_TWO(words, from_a, from_b, to_a, to_b)                                         \
  LOAD_##words("t0", "t1", "t2", "t3", from_a) LOAD_##words("t4", "t5", "a6", "a7", from_b) \
      STORE_##words("t0", "t1", "t2", "t3", to_a) STORE_##words("t4", "t5", "a6", "a7", to_b)
// `length` is the number of instructions of the loop, 8 x `words`.
#define COPY_ROWS(words, length)                                                                                       \
  __asm__ volatile(XPULP_LOOP("x0", "%[n]", length) COPY_TWO(words, "%[a]", "%[b]", "%[to_a]", "%[to_b]")              \
                       COPY_TWO(words, "%[c]", "%[d]", "%[to_c]", "%[to_d]") XPULP_LOOP_END                            \
                   : [a] "+r"(a), [b] "+r"(b), [c] "+r"(c), [d] "+r"(d), [to_a] "+r"(to_a), [to_b] "+r"(to_b),         \
                     [to_c] "+r"(to_c), [to_d] "+r"(to_d)                                                              \
                   : [n] "r"(layer->gather_rows), [step] "r"(layer->gather_row_step), [bytes] "r"(layer->gather_bytes) \
                   : "t0", "t1", "t2", "t3", "t4", "t5", "a6", "a7", "memory")

// Copies the rows of four patches to `to`. A row must have at most 16 bytes. Each copy takes layer->gathered_bytes
// bytes.
static inline __attribute__((always_inline)) void gather_short_rows(const layer_t* layer,
                                                                    const uint8_t* const patches[4], uint8_t* to) {
  const int32_t size = layer->gathered_bytes;
  const uint8_t *a = patches[0], *b = patches[1], *c = patches[2], *d = patches[3];
  uint8_t *to_a = to, *to_b = to + size, *to_c = to + 2 * size, *to_d = to + 3 * size;
  if (layer->gather_bytes > 12) {
    COPY_ROWS(4, "32");
  } else if (layer->gather_bytes > 8) {
    COPY_ROWS(3, "24");
  } else if (layer->gather_bytes > 4) {
    COPY_ROWS(2, "16");
  } else {
    COPY_ROWS(1, "8");
  }
}

#endif

// Copies four patches to addresses `gathered_bytes` apart.
static inline __attribute__((always_inline)) void gather(const layer_t* layer, const uint8_t* const patches[4],
                                                         uint8_t* to) {
  const int32_t rows = layer->gather_rows, runs = layer->gather_runs, bytes = layer->gather_bytes;
#ifdef __riscv
  if (runs == 1 && bytes <= 16) {
    gather_short_rows(layer, patches, to);
    return;
  }
#endif
  for (int i = 0; i < 4; ++i, to += layer->gathered_bytes) {
    for (int32_t y = 0; y < rows; ++y) {
      const uint8_t* row = patches[i] + y * layer->gather_row_step;
      copy_ranges(to + y * runs * bytes, row, runs, bytes, layer->gather_step);
    }
  }
}

// Sets the values outside the input in copied patches. `x` is the column of the first position.
static void fill_outside(const layer_t* layer, int32_t x, int32_t columns, int is_pooled, uint8_t* to) {
  const int32_t bytes = layer->gather_bytes;
  for (int i = 0; i < 4; ++i, to += layer->gathered_bytes) {
    int32_t place = is_pooled ? 2 * x + i % 2 : x + i;
    while (!is_pooled && place >= columns) {
      place -= columns;
    }
    const int32_t first = place * layer->stride_columns - layer->outside_left;
    const int32_t begin = smaller(-first * layer->in_channels, bytes);
    const int32_t end = larger((layer->in_columns - first) * layer->in_channels, 0);
    if (begin <= 0 && end >= bytes) {
      continue;
    }
    uint8_t* row = to;
    for (int32_t y = layer->gather_rows; y > 0; --y, row += bytes) {
      for (int32_t at = 0; at < begin; ++at) {
        row[at] = layer->outside;
      }
      for (int32_t at = end; at < bytes; ++at) {
        row[at] = layer->outside;
      }
    }
  }
}

// Columns at which a block of four positions may start, so that all patches are inside the input and in one row.
typedef struct {
  int32_t first, last;
} columns_t;

static columns_t columns_inside(const layer_t* layer, int32_t columns, int is_pooled) {
  const int32_t each = is_pooled ? 2 : 1;
  const int32_t stride = layer->stride_columns;
  const int32_t last = (layer->in_columns + layer->outside_left - layer->kernel_columns) / stride;
  const columns_t inside = {(layer->outside_left + each * stride - 1) / (each * stride),
                            is_pooled ? (last + 1) / 2 - 1 : smaller(last - 3, columns - 4)};
  return inside;
}

// The output position at which next_four() or next_pooled() continues.
typedef struct {
  int32_t x;
  int32_t columns;
  const uint8_t* row;  // patch of the first position of the row
  int32_t to_next;     // bytes from patch to patch in a row
  int32_t to_lower;
} places_t;

// Performs next_four() if the positions may be in several rows, or may be fewer than four.
static __attribute__((noinline)) void next_few(places_t* at, int32_t left, const uint8_t* patches[4]) {
  const uint8_t* patch = at->row + at->x * at->to_next;
  for (int i = 0; i < 4; ++i, --left) {
    patches[i] = patch;
    if (left <= 1) {
      continue;
    }
    patch += at->to_next;
    if (++at->x == at->columns) {
      at->x = 0;
      at->row += at->to_lower;
      patch = at->row;
    }
  }
}

// Sets `patches` to the patches of the next four output positions. If fewer than four positions are `left`, repeats the
// last patch.
static inline __attribute__((always_inline)) void next_four(places_t* at, int32_t left, const uint8_t* patches[4]) {
  if (at->x + 4 > at->columns) {
    next_few(at, left, patches);
    return;
  }
  const uint8_t* patch = at->row + at->x * at->to_next;
  for (int i = 0; i < 4; ++i, patch += at->to_next) {
    patches[i] = patch;
  }
  at->x += 4;
  if (at->x == at->columns) {
    at->x = 0;
    at->row += at->to_lower;
  }
}

// Sets `patches` to the patches of the 2 x 2 positions of the next pool.
static inline __attribute__((always_inline)) void next_pooled(places_t* at, const uint8_t* patches[4]) {
  const uint8_t* patch = at->row + 2 * at->x * at->to_next;
  patches[0] = patch;
  patches[1] = patch + at->to_next;
  patches[2] = patch + at->to_lower;
  patches[3] = patches[2] + at->to_next;
  if (++at->x == at->columns) {
    at->x = 0;
    at->row += 2 * at->to_lower;
  }
}

// Reduces four sums to the greatest, so that only one sum must be requantised. All multipliers are positive, so that
// the greatest sum gives the greatest byte.
static inline __attribute__((always_inline)) void keep_largest(int32_t sums[16]) {
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    sums[i] = larger(larger(sums[i], sums[4 + i]), larger(sums[8 + i], sums[12 + i]));
  }
}

// Computes `groups` groups of channels at `count` output positions, and stores the bytes at block->to. The first
// `whole` groups have four channels.
static inline __attribute__((always_inline)) void compute(const layer_t* layer, block_t* block, int32_t groups,
                                                          int32_t whole, int32_t count, int is_pooled, int scaling) {
#ifdef __riscv
  if (scaling != SCALING_NONE && whole > 0 && (is_pooled || count == 4)) {
    block->groups = whole;
    compute_bytes(block, is_pooled, scaling);
    groups -= whole;
  }
#else
  (void)whole;
#endif
  for (; groups > 0; --groups) {
    if (!is_pooled && count == 1) {
      compute_first_sums(block, scaling);
    } else {
      compute_sums(block, scaling);
    }
    if (is_pooled) {
      keep_largest(block->sums);
    }
    store_places(layer, block->group, block->sums, block->to, block->to_next, count, scaling);
    block->group = (const layer_group_t*)(const void*)((const uint8_t*)block->group + layer->group_bytes);
    block->to += 4 * layer->element;
  }
}

static inline __attribute__((always_inline)) void convolve(const layer_step_t* step, layer_share_t share, int is_pooled,
                                                           int scaling) {
  const layer_t* layer = step->layer;
  const int32_t pool = is_pooled ? 1 : layer->pool;
  const int32_t columns = layer->out_columns * pool;
  const int32_t count = step->rows * pool * columns;
  const int32_t each = is_pooled ? 1 : 4;  // positions of a unit
  const int32_t blocks = (count + each - 1) / each;
  const int gathers = layer->gather_runs > 0;
  const int32_t element = layer->element;
  const int32_t channels = step->channels * element;
  // A unit is a block with one group of channels. Usually, the cores divide all units among each other. If there are
  // fewer blocks than cores, and the last block has only one position, each core computes all blocks, but only a part
  // of the groups.
  range_t groups = {0, step->groups};
  range_t units;
  if (!gathers && blocks < share.cores && count % each == 1 && step->groups % share.cores == 0) {
    groups = range_of(step->groups, share);
    units.begin = 0;
    units.end = blocks * (groups.end - groups.begin);
  } else {
    units = range_of(blocks * step->groups, share);
  }
  const int32_t group_count = groups.end - groups.begin;
  int32_t unit = units.begin;
  int32_t place = unit / group_count;
  int32_t number = unit - place * group_count + groups.begin;
  place *= each;
  uint8_t* to = (layer->then != 0 ? step->unpooled : step->out) + place * channels;
  const int32_t to_lower = layer->stride_rows * step->in_pitch;
  const int32_t y = place / columns;
  // The tile contains no columns outside the input. `in` is the address at which the first row would begin if it
  // contained them.
  const uint8_t* in = step->in - layer->outside_left * step->in_channels;
  places_t at = {place - y * columns, columns, in + y * (is_pooled ? 2 : 1) * to_lower,
                 layer->stride_columns * step->in_channels, to_lower};
  const int has_sides = layer->outside_left + layer->outside_right > 0;
  columns_t inside = {0, 0};
  if (has_sides) {
    inside = columns_inside(layer, columns, is_pooled);
  }
  block_t block;  // without an initialiser, which would clear the sums
  block.runs = layer->runs_y;
  block.words = layer->run_words;
  block.step = layer->step_y;
  block.low = layer->low;
  block.high = layer->high;
  block.to_next = channels;
  const uint8_t* sources[4];
  const uint8_t** patches = gathers ? sources : block.patches;
  for (int i = 0; i < 4; ++i) {
    block.patches[i] = step->gathered + i * layer->gathered_bytes;
  }
  const int32_t whole_groups = step->channels / 4;
  for (; unit < units.end; place += each, to += each * channels, number = groups.begin) {
    const int32_t x = at.x;
    if (is_pooled) {
      next_pooled(&at, patches);
    } else {
      next_four(&at, count - place, patches);
    }
    if (gathers) {
      gather(layer, patches, step->gathered);
      if (has_sides && (x < inside.first || x > inside.last)) {
        fill_outside(layer, x, columns, is_pooled, step->gathered);
      }
    }
    const int32_t computed = smaller(groups.end - number, units.end - unit);
    block.group = (const layer_group_t*)(const void*)(step->data + number * layer->group_bytes);
    block.to = to + number * 4 * element;
    compute(layer, &block, computed, smaller(whole_groups - number, computed), smaller(count - place, each), is_pooled,
            scaling);
    unit += computed;
  }
}

#define DEFINE(name, scaling)                                                               \
  void layer_convolve_blocks_##name(const layer_step_t* step, layer_share_t share) {        \
    convolve(step, share, 0, scaling);                                                      \
  }                                                                                         \
  void layer_convolve_blocks_pooled_##name(const layer_step_t* step, layer_share_t share) { \
    convolve(step, share, 1, scaling);                                                      \
  }

DEFINE(narrow, SCALING_NARROW)
DEFINE(wide, SCALING_WIDE)
DEFINE(exact, SCALING_EXACT)

void layer_convolve_blocks_none(const layer_step_t* step, layer_share_t share) {
  convolve(step, share, 0, SCALING_NONE);
}
