// SPDX-License-Identifier: Apache-2.0
// Parts of kernels that several networks share: dot products for two output positions and four channels, and the
// conversion of sums to bytes.
#pragma once

#include "runtime/xpulp.h"

// Adds dot products to the sums of two output positions (a0 to a3, b0 to b3). Loads `words` words from each patch (p0,
// p1) and from the weights of each channel (w0 to w3). Six loads provide the operands of eight dot products.
#define ROW_OF_PATCH                                                                                             \
  __asm__ volatile(                                                                                              \
      XPULP_LOOP("x0", "%[n]", "14") XPULP_LW_POST("t0", "4", "%[w0]") XPULP_LW_POST("t1", "4", "%[w1]")         \
          XPULP_LW_POST("t2", "4", "%[w2]") XPULP_LW_POST("t3", "4", "%[w3]") XPULP_LW_POST("t4", "4", "%[p0]")  \
              XPULP_LW_POST("t5", "4", "%[p1]") XPULP_SDOTUSP_B("%[a0]", "t4", "t0") XPULP_SDOTUSP_B(            \
                  "%[a1]", "t4", "t1") XPULP_SDOTUSP_B("%[a2]", "t4", "t2") XPULP_SDOTUSP_B("%[a3]", "t4", "t3") \
                  XPULP_SDOTUSP_B("%[b0]", "t5", "t0") XPULP_SDOTUSP_B("%[b1]", "t5", "t1")                      \
                      XPULP_SDOTUSP_B("%[b2]", "t5", "t2") XPULP_SDOTUSP_B("%[b3]", "t5", "t3") XPULP_LOOP_END   \
      : [a0] "+r"(a0), [a1] "+r"(a1), [a2] "+r"(a2), [a3] "+r"(a3), [b0] "+r"(b0), [b1] "+r"(b1), [b2] "+r"(b2), \
        [b3] "+r"(b3), [w0] "+r"(w0), [w1] "+r"(w1), [w2] "+r"(w2), [w3] "+r"(w3), [p0] "+r"(p0), [p1] "+r"(p1)  \
      : [n] "r"(words)                                                                                           \
      : "t0", "t1", "t2", "t3", "t4", "t5", "memory")

// Like ROW_OF_PATCH, but only for the first output position (p0).
#define ROW_OF_ONE_PATCH                                                                                             \
  __asm__ volatile(XPULP_LOOP("x0", "%[n]", "9") XPULP_LW_POST("t4", "4", "%[p0]") XPULP_LW_POST("t0", "4", "%[w0]") \
                       XPULP_LW_POST("t1", "4", "%[w1]") XPULP_LW_POST("t2", "4", "%[w2]")                           \
                           XPULP_LW_POST("t3", "4", "%[w3]") XPULP_SDOTUSP_B("%[a0]", "t4", "t0")                    \
                               XPULP_SDOTUSP_B("%[a1]", "t4", "t1") XPULP_SDOTUSP_B("%[a2]", "t4", "t2")             \
                                   XPULP_SDOTUSP_B("%[a3]", "t4", "t3") XPULP_LOOP_END                               \
                   : [a0] "+r"(a0), [a1] "+r"(a1), [a2] "+r"(a2), [a3] "+r"(a3), [w0] "+r"(w0), [w1] "+r"(w1),       \
                     [w2] "+r"(w2), [w3] "+r"(w3), [p0] "+r"(p0)                                                     \
                   : [n] "r"(words)                                                                                  \
                   : "t0", "t1", "t2", "t3", "t4", "memory")

// Like ROW_OF_ONE_PATCH, but the weights (w) are word by word, each for four channels.
#define INTERLEAVED_ROW_OF_ONE_PATCH                                                                                \
  __asm__ volatile(XPULP_LOOP("x0", "%[n]", "9") XPULP_LW_POST("t4", "4", "%[p0]") XPULP_LW_POST("t0", "4", "%[w]") \
                       XPULP_LW_POST("t1", "4", "%[w]") XPULP_LW_POST("t2", "4", "%[w]")                            \
                           XPULP_LW_POST("t3", "4", "%[w]") XPULP_SDOTUSP_B("%[a0]", "t4", "t0")                    \
                               XPULP_SDOTUSP_B("%[a1]", "t4", "t1") XPULP_SDOTUSP_B("%[a2]", "t4", "t2")            \
                                   XPULP_SDOTUSP_B("%[a3]", "t4", "t3") XPULP_LOOP_END                              \
                   : [a0] "+r"(a0), [a1] "+r"(a1), [a2] "+r"(a2), [a3] "+r"(a3), [w] "+r"(w), [p0] "+r"(p0)         \
                   : [n] "r"(words)                                                                                 \
                   : "t0", "t1", "t2", "t3", "t4", "memory")

static inline __attribute__((always_inline)) uint32_t pack_bytes(int32_t a, int32_t b, int32_t c, int32_t d) {
  return xpulp_packhi_b(xpulp_packlo_b(0, (uint32_t)b, (uint32_t)a), (uint32_t)d, (uint32_t)c);
}
