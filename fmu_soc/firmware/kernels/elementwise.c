// SPDX-License-Identifier: Apache-2.0
// Implements operators that compute an output byte from the input bytes at the same position. Each core computes a
// contiguous part of the tile.
#include "kernels/requantise.h"
#include "kernels/work.h"

static range_t part_of(const layer_step_t* step, layer_share_t share) {
  const int32_t bytes = step->rows * step->layer->out_columns * step->channels;
  const int32_t each = ((bytes + share.cores - 1) / share.cores + 3) & ~3;
  const range_t part = {smaller(share.core * each, bytes), smaller((share.core + 1) * each, bytes)};
  return part;
}

static inline __attribute__((always_inline)) int32_t sum_of(const layer_t* layer, int32_t a, int32_t b) {
  return limited((a * layer->factors[0] + b * layer->factors[1] + layer->addend) >> layer->shift, layer->low,
                 layer->high);
}

#ifdef __riscv

#define BYTE(word, i) ((int32_t)xpulp_extractu(word, 8, 8 * (i)))

#define EXTRACT(to, from, bit) ".insn r 0x33, 1, 0x67, " to ", " from ", x" bit "\n\t"
#define EXTRACT_FOUR(a, b, c, d, from) \
  EXTRACT(b, from, "8") EXTRACT(c, from, "16") EXTRACT(d, from, "24") EXTRACT(a, from, "0")
#define MULTIPLY(a) "mul " a ", " a ", %[f0]\n\t"
#define ADD_PRODUCT(a, b) XPULP_MAC(a, b, "%[f1]")
#define SHIFT_AND_LIMIT(a) XPULP_ADDNR(a, "%[addend]", "%[shift]") XPULP_CLIPUR(a, a, "%[high]")

// Computes the sums of the bytes of `a` and `b`, `fours` times four bytes. `layer->low` must be 0.
static inline __attribute__((always_inline)) void add_from_zero(const layer_t* layer, const uint8_t* a,
                                                                const uint8_t* b, uint8_t* to, int32_t fours) {
  __asm__ volatile(
      XPULP_LOOP("x0", "%[n]", "29") XPULP_LW_POST("t0", "4", "%[a]") XPULP_LW_POST("t4", "4", "%[b]")
          EXTRACT_FOUR("t0", "t1", "t2", "t3", "t0") EXTRACT_FOUR("t4", "t5", "a6", "a7", "t4") MULTIPLY("t0")
              MULTIPLY("t1") MULTIPLY("t2") MULTIPLY("t3") ADD_PRODUCT("t0", "t4") ADD_PRODUCT("t1", "t5")
                  ADD_PRODUCT("t2", "a6") ADD_PRODUCT("t3", "a7") SHIFT_AND_LIMIT("t0") SHIFT_AND_LIMIT("t1")
                      SHIFT_AND_LIMIT("t2") SHIFT_AND_LIMIT("t3") XPULP_PACKLO_B("t0", "t1", "t0")
                          XPULP_PACKHI_B("t0", "t3", "t2") XPULP_SW_POST("t0", "4", "%[to]") XPULP_LOOP_END
      : [a] "+r"(a), [b] "+r"(b), [to] "+r"(to)
      : [n] "r"(fours), [f0] "r"(layer->factors[0]), [f1] "r"(layer->factors[1]), [addend] "r"(layer->addend),
        [shift] "r"(layer->shift), [high] "r"((int32_t)layer->high)
      : "t0", "t1", "t2", "t3", "t4", "t5", "a6", "a7", "memory");
}

// Computes the sums of the bytes of `a` and `b`, four at a time. Returns the number of computed bytes, a multiple of
// four.
static inline __attribute__((always_inline)) int32_t add_fours(const layer_t* layer, const uint8_t* a, const uint8_t* b,
                                                               uint8_t* to, int32_t count) {
  if (layer->low == 0 && count > 3) {
    add_from_zero(layer, a, b, to, count / 4);
    return count & ~3;
  }
  const int32_t f0 = layer->factors[0], f1 = layer->factors[1];
  const uint32_t addend = (uint32_t)layer->addend, shift = (uint32_t)layer->shift;
  const int32_t low = layer->low, high = layer->high;
  for (int32_t left = count / 4; left > 0; --left) {
    const uint32_t x = xpulp_lw_post(a, 4), y = xpulp_lw_post(b, 4);
    const int32_t bytes[4] = {
        limited(xpulp_addNr(xpulp_mac(BYTE(x, 0) * f0, BYTE(y, 0), f1), addend, shift), low, high),
        limited(xpulp_addNr(xpulp_mac(BYTE(x, 1) * f0, BYTE(y, 1), f1), addend, shift), low, high),
        limited(xpulp_addNr(xpulp_mac(BYTE(x, 2) * f0, BYTE(y, 2), f1), addend, shift), low, high),
        limited(xpulp_addNr(xpulp_mac(BYTE(x, 3) * f0, BYTE(y, 3), f1), addend, shift), low, high)};
    store_four(to, bytes);
    to += 4;
  }
  return count & ~3;
}

static inline __attribute__((always_inline)) int32_t look_up_fours(const uint8_t* table, const uint8_t* in, uint8_t* to,
                                                                   int32_t count) {
  for (int32_t left = count / 4; left > 0; --left) {
    const uint32_t x = xpulp_lw_post(in, 4);
    const int32_t bytes[4] = {table[BYTE(x, 0)], table[BYTE(x, 1)], table[BYTE(x, 2)], table[BYTE(x, 3)]};
    store_four(to, bytes);
    to += 4;
  }
  return count & ~3;
}

#else

static int32_t add_fours(const layer_t* layer, const uint8_t* a, const uint8_t* b, uint8_t* to, int32_t count) {
  (void)layer, (void)a, (void)b, (void)to, (void)count;
  return 0;
}

static int32_t look_up_fours(const uint8_t* table, const uint8_t* in, uint8_t* to, int32_t count) {
  (void)table, (void)in, (void)to, (void)count;
  return 0;
}

#endif

void layer_add(const layer_step_t* step, layer_share_t share) {
  const layer_t* layer = step->layer;
  const range_t part = part_of(step, share);
  const uint8_t *a = step->in, *b = step->other;
  int32_t i = part.begin;
  for (i += add_fours(layer, a + i, b + i, step->out + i, part.end - i); i < part.end; ++i) {
    step->out[i] = (uint8_t)sum_of(layer, a[i], b[i]);
  }
}

void layer_multiply(const layer_step_t* step, layer_share_t share) {
  const layer_t* layer = step->layer;
  const range_t part = part_of(step, share);
  const int32_t z0 = layer->zeros[0], z1 = layer->zeros[1];
  for (int32_t i = part.begin; i < part.end; ++i) {
    const int32_t product = (step->in[i] - z0) * (step->other[i] - z1);
    const int32_t value =
        scaled(product, layer->factors[0], layer->addend, layer->shift, layer->scaling == SCALING_WIDE);
    step->out[i] = (uint8_t)limited(value, layer->low, layer->high);
  }
}

void layer_table(const layer_step_t* step, layer_share_t share) {
  const range_t part = part_of(step, share);
  const uint8_t* table = step->data;
  int32_t i = part.begin;
  for (i += look_up_fours(table, step->in + i, step->out + i, part.end - i); i < part.end; ++i) {
    step->out[i] = table[step->in[i]];
  }
}
