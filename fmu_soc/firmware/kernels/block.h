// SPDX-License-Identifier: Apache-2.0
// Computes products of four patches with the weights of four output channels.
#pragma once

#include <stddef.h>

#include "kernels/requantise.h"

// Four output positions, and one or more groups of four output channels. The assembly code accesses the fields by their
// offsets.
typedef struct {
  int32_t runs;   // ranges of contiguous bytes in a patch
  int32_t words;  // words in a run
  int32_t step;   // bytes from the end of a run to the start of the next one
  int32_t low;
  int32_t high;
  int32_t to_next;  // bytes from one output position to the next
  const layer_group_t* group;
  int32_t groups;             // number of groups, from `group` on
  uint8_t* to;                // outputs of `group` at the first position
  const uint8_t* patches[4];  // of the four positions
  int32_t sums[16];           // four channels of the first position, then of the second position, and so on
} block_t;

#ifdef __riscv

#define FOUR_PRODUCTS(a, b, c, d, patch) \
  XPULP_SDOTUSP_B(a, patch, "t0")        \
  XPULP_SDOTUSP_B(b, patch, "t1") XPULP_SDOTUSP_B(c, patch, "t2") XPULP_SDOTUSP_B(d, patch, "t3")

// The number of bytes of a group before its weights: layer_group_t, and with SCALING_EXACT the lower words of the
// addends.
#define HEADER(scaling) (sizeof(layer_group_t) + ((scaling) == SCALING_EXACT ? 16 : 0))

#define FIELD(name) "%[" #name "](%[block])\n\t"

// Computes the sums of four positions and of one group of four channels in s0 to s11 and a4 to a7. Eight loads provide
// the operands of sixteen dot products. The weights are interleaved: one word for each of four channels. At the end, w
// is the address of the next group.
#define COMPUTE_SUMS \
  "lw %[w], " FIELD(group)                                                                                             \
  "lw %[p0], %[patches](%[block])\n\tlw %[p1], %[patches]+4(%[block])\n\t"                                            \
  "lw %[p2], %[patches]+8(%[block])\n\tlw %[p3], %[patches]+12(%[block])\n\t"                                         \
  "lw s0, %[bias](%[w])\n\tlw s1, %[bias]+4(%[w])\n\tlw s2, %[bias]+8(%[w])\n\tlw s3, %[bias]+12(%[w])\n\t"            \
  "lw t4, " FIELD(runs) "addi %[w], %[w], %[header]\n\t"                                                              \
  "mv s4, s0\n\tmv s5, s1\n\tmv s6, s2\n\tmv s7, s3\n\tmv s8, s0\n\tmv s9, s1\n\tmv s10, s2\n\tmv s11, s3\n\t"         \
  "mv a4, s0\n\tmv a5, s1\n\tmv a6, s2\n\tmv a7, s3\n\t"                                                               \
  XPULP_LOOP("x1", "t4", "31") "lw t4, " FIELD(words) XPULP_LOOP("x0", "t4", "24")                                     \
      XPULP_LW_POST("t0", "4", "%[w]") XPULP_LW_POST("t1", "4", "%[w]") XPULP_LW_POST("t2", "4", "%[w]")               \
          XPULP_LW_POST("t3", "4", "%[w]") XPULP_LW_POST("t4", "4", "%[p0]") XPULP_LW_POST("t5", "4", "%[p1]")         \
              FOUR_PRODUCTS("s0", "s1", "s2", "s3", "t4") XPULP_LW_POST("t4", "4", "%[p2]")                            \
                  FOUR_PRODUCTS("s4", "s5", "s6", "s7", "t5") XPULP_LW_POST("t5", "4", "%[p3]")                        \
                      FOUR_PRODUCTS("s8", "s9", "s10", "s11", "t4")                                                    \
                          FOUR_PRODUCTS("a4", "a5", "a6", "a7", "t5") XPULP_LOOP_END                                   \
  "lw t5, " FIELD(step) "add %[p0], %[p0], t5\n\tadd %[p1], %[p1], t5\n\tadd %[p2], %[p2], t5\n\t"                     \
  "add %[p3], %[p3], t5\n\t" XPULP_LOOP_END

#define KEEP(a, b, c, d, place)                                       \
  "sw " a ", %[sums]+" place "(%[block])\n\tsw " b ", %[sums]+" place \
  "+4(%[block])\n\t"                                                  \
  "sw " c ", %[sums]+" place "+8(%[block])\n\tsw " d ", %[sums]+" place "+12(%[block])\n\t"
#define KEEP_SUMS                   \
  KEEP("s0", "s1", "s2", "s3", "0") \
  KEEP("s4", "s5", "s6", "s7", "16") KEEP("s8", "s9", "s10", "s11", "32") KEEP("a4", "a5", "a6", "a7", "48")

// Maximum of the sums of four positions. All multipliers are positive, so that the greatest sum gives the greatest
// byte.
#define LARGEST(a, b, c, d) XPULP_MAX(a, a, b) XPULP_MAX(c, c, d) XPULP_MAX(a, a, c)
#define KEEP_LARGEST              \
  LARGEST("s0", "s4", "s8", "a4") \
  LARGEST("s1", "s5", "s9", "a5") LARGEST("s2", "s6", "s10", "a6") LARGEST("s3", "s7", "s11", "a7")

// Multiply a sum by the multiplier in t0. EXACT adds the lower word of the addend. p0 and p1 are free at that time.
#define NARROW(a) "mul " a ", " a ", t0\n\t"
#define WIDE(a) "mulh " a ", " a ", t0\n\t"
#define EXACT(a)                                                                               \
  "mulh %[p0], " a ", t0\n\tmul " a ", " a ", t0\n\tadd " a ", " a ", %[p1]\n\tsltu " a ", " a \
  ", %[p1]\n\t"                                                                                \
  "add " a ", " a ", %[p0]\n\t"

// Limit a value to the bounds t3 and t4. FROM_ZERO is faster, but requires that the lower bound is 0.
#define BETWEEN(a) XPULP_MAX(a, a, "t3") XPULP_MIN(a, a, "t4")
#define FROM_ZERO(a) XPULP_CLIPUR(a, a, "t4")

// Converts a channel's sum to a byte. Registers: addend t1, shift t2, bounds t3 and t4, address of the layer_group_t
// t5.
#define CONVERT(product, limit, a) product(a) XPULP_ADDNR(a, "t1", "t2") limit(a)
#define LOWER_OF_NARROW(channel) ""
#define LOWER_OF_WIDE(channel) ""
#define LOWER_OF_EXACT(channel) "lw %[p1], %[lower]+4*" channel "(t5)\n\t"
#define LOAD_NUMBERS(product, channel)                                    \
  "lw t0, %[multiplier]+4*" channel "(t5)\n\tlw t1, %[addend]+4*" channel \
  "(t5)\n\t" LOWER_OF_##product(channel) "lbu t2, %[shift]+" channel "(t5)\n\t"
#define CONVERT_CHANNEL(product, limit, channel, a, b, c, d) \
  LOAD_NUMBERS(product, channel)                             \
  CONVERT(product, limit, a) CONVERT(product, limit, b) CONVERT(product, limit, c) CONVERT(product, limit, d)
#define CONVERT_LARGEST(product, limit, channel, a) LOAD_NUMBERS(product, channel) CONVERT(product, limit, a)

#define STORE(a, b, c, d) XPULP_PACKLO_B(a, b, a) XPULP_PACKHI_B(a, d, c) XPULP_SW_POST_REG(a, "t1", "t0")
#define LOAD_BOUNDS "lw t3, " FIELD(low) "lw t4, " FIELD(high) "lw t5, " FIELD(group) "sw %[w], " FIELD(group)
// Loads the address of the first position's outputs into t0, the distance to the next position into t1, and the number
// of groups that are left into t3. The outputs of the next group are four bytes later.
#define LOAD_PLACE \
  "lw t0, " FIELD(to) "lw t1, " FIELD(to_next) "lw t3, " FIELD(groups) "addi t2, t0, 4\n\tsw t2, " FIELD(to)

#define CONVERT_AND_STORE(product, limit)                                                                            \
  LOAD_BOUNDS CONVERT_CHANNEL(product, limit, "0", "s0", "s4", "s8", "a4")                                           \
      CONVERT_CHANNEL(product, limit, "1", "s1", "s5", "s9", "a5")                                                   \
          CONVERT_CHANNEL(product, limit, "2", "s2", "s6", "s10", "a6")                                              \
              CONVERT_CHANNEL(product, limit, "3", "s3", "s7", "s11", "a7") LOAD_PLACE STORE("s0", "s1", "s2", "s3") \
                  STORE("s4", "s5", "s6", "s7") STORE("s8", "s9", "s10", "s11") STORE("a4", "a5", "a6", "a7")
#define CONVERT_AND_STORE_LARGEST(product, limit)                                                                \
  KEEP_LARGEST LOAD_BOUNDS CONVERT_LARGEST(product, limit, "0", "s0") CONVERT_LARGEST(product, limit, "1", "s1") \
      CONVERT_LARGEST(product, limit, "2", "s2") CONVERT_LARGEST(product, limit, "3", "s3")                      \
          LOAD_PLACE STORE("s0", "s1", "s2", "s3")

// Executes `text` for each group. `text` must contain LOAD_PLACE, which loads the number of groups that are left.
#define FOR_EACH_GROUP(text) "1:\n\t" text "addi t3, t3, -1\n\tsw t3, " FIELD(groups) "bnez t3, 1b\n\t"

#define RUN(text)                                                                                                     \
  __asm__ volatile(                                                                                                   \
      text                                                                                                            \
      : [p0] "=&r"(p0), [p1] "=&r"(p1), [p2] "=&r"(p2), [p3] "=&r"(p3), [w] "=&r"(w)                                  \
      : [block] "r"(block), [bias] "i"(offsetof(layer_group_t, bias)), [header] "i"(HEADER(scaling)),                 \
        [runs] "i"(offsetof(block_t, runs)), [words] "i"(offsetof(block_t, words)),                                   \
        [step] "i"(offsetof(block_t, step)), [low] "i"(offsetof(block_t, low)), [high] "i"(offsetof(block_t, high)),  \
        [to] "i"(offsetof(block_t, to)), [to_next] "i"(offsetof(block_t, to_next)),                                   \
        [group] "i"(offsetof(block_t, group)), [groups] "i"(offsetof(block_t, groups)),                               \
        [patches] "i"(offsetof(block_t, patches)), [sums] "i"(offsetof(block_t, sums)),                               \
        [multiplier] "i"(offsetof(layer_group_t, multiplier)), [addend] "i"(offsetof(layer_group_t, addend)),         \
        [shift] "i"(offsetof(layer_group_t, shift)), [lower] "i"(sizeof(layer_group_t))                               \
      : "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9", "s10", "s11", "t0", "t1", "t2", "t3", "t4", "t5", \
        "a4", "a5", "a6", "a7", "memory")

// Computes the sums of the block's first group.
static inline __attribute__((always_inline)) void compute_sums(block_t* block, int scaling) {
  const uint8_t *p0, *p1, *p2, *p3, *w;
  RUN(COMPUTE_SUMS KEEP_SUMS);
}

#define RUN_LIMITED(convert, product)                              \
  if (block->low == 0) {                                           \
    RUN(FOR_EACH_GROUP(COMPUTE_SUMS convert(product, FROM_ZERO))); \
  } else {                                                         \
    RUN(FOR_EACH_GROUP(COMPUTE_SUMS convert(product, BETWEEN)));   \
  }

// Computes and stores the output bytes of four positions for all groups, which have four channels each. If `is_pooled`
// is set, stores for each channel only the byte of the greatest sum. Advances `group` and `to`.
static inline __attribute__((always_inline)) void compute_bytes(block_t* block, int is_pooled, int scaling) {
  const uint8_t *p0, *p1, *p2, *p3, *w;
  if (is_pooled && scaling == SCALING_NARROW) {
    RUN_LIMITED(CONVERT_AND_STORE_LARGEST, NARROW)
  } else if (is_pooled && scaling == SCALING_WIDE) {
    RUN_LIMITED(CONVERT_AND_STORE_LARGEST, WIDE)
  } else if (is_pooled) {
    RUN_LIMITED(CONVERT_AND_STORE_LARGEST, EXACT)
  } else if (scaling == SCALING_NARROW) {
    RUN_LIMITED(CONVERT_AND_STORE, NARROW)
  } else if (scaling == SCALING_WIDE) {
    RUN_LIMITED(CONVERT_AND_STORE, WIDE)
  } else {
    RUN_LIMITED(CONVERT_AND_STORE, EXACT)
  }
}

// Computes the sums of the first position only.
static inline __attribute__((always_inline)) void compute_first_sums(block_t* block, int scaling) {
  const uint8_t* p0 = block->patches[0];
  const int8_t* w = weights_of(block->group, scaling);
  const int32_t* bias = block->group->bias;
  int32_t a0 = bias[0], a1 = bias[1], a2 = bias[2], a3 = bias[3];
  for (int32_t run = block->runs; run > 0; --run, p0 += block->step) {
    const int32_t words = block->words;
    INTERLEAVED_ROW_OF_ONE_PATCH;
  }
  block->sums[0] = a0, block->sums[1] = a1, block->sums[2] = a2, block->sums[3] = a3;
}

#else

static inline void compute_sums(block_t* block, int scaling) {
  for (int i = 0; i < 16; ++i) {
    const int8_t* weight = weights_of(block->group, scaling) + i % 4 * 4;
    const uint8_t* p = block->patches[i / 4];
    int32_t sum = block->group->bias[i % 4];
    for (int32_t run = 0; run < block->runs; ++run, p += block->step) {
      for (int32_t word = 0; word < block->words; ++word, weight += 16, p += 4) {
        sum += p[0] * weight[0] + p[1] * weight[1] + p[2] * weight[2] + p[3] * weight[3];
      }
    }
    block->sums[i] = sum;
  }
}

static inline void compute_first_sums(block_t* block, int scaling) {
  compute_sums(block, scaling);
}

#endif
