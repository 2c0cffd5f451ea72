// SPDX-License-Identifier: Apache-2.0
#include "kernels.h"

#include "runtime/xpulp.h"

// A shift by this number of bits converts a sum to a byte.
#define SHIFT 7

static int8_t narrow(int32_t sum) {
  const int32_t value = sum >> SHIFT;
  return (int8_t)(value > 127 ? 127 : value < -128 ? -128 : value);
}

// Returns the first row of a core. All cores together compute `count` rows.
static unsigned first_of(unsigned count, const job_t* job, unsigned core) {
  return count * core / job->cores;
}

void convolution_plain(const job_t* shared, unsigned core) {
  const job_t job = *shared;  // copies the job, which is in L2
  const unsigned end = first_of(kOut, &job, core + 1);
  for (unsigned y = first_of(kOut, &job, core); y < end; ++y) {
    for (unsigned x = 0; x < kOut; ++x) {
      int32_t sum = 0;
      for (unsigned row = 0; row < 5; ++row) {
        for (unsigned column = 0; column < 5; ++column) {
          sum += job.pixels[(y + row) * kWidth + x + column] * job.weights[row * 5 + column];
        }
      }
      job.out[y * kOut + x] = narrow(sum);
    }
  }
}

// A row of five taps. No instruction uses the result of the load directly before it.
// clang-format off
#define TAPS_OF_A_ROW                                                 \
  XPULP_LB_POST("t0", "1", "%[p]") XPULP_LB_POST("t1", "1", "%[w]")   \
  XPULP_LB_POST("t2", "1", "%[p]") XPULP_LB_POST("t3", "1", "%[w]")   \
  XPULP_MAC("%[sum]", "t0", "t1")                                     \
  XPULP_LB_POST("t0", "1", "%[p]") XPULP_LB_POST("t1", "1", "%[w]")   \
  XPULP_MAC("%[sum]", "t2", "t3")                                     \
  XPULP_LB_POST("t2", "1", "%[p]") XPULP_LB_POST("t3", "1", "%[w]")   \
  XPULP_MAC("%[sum]", "t0", "t1")                                     \
  XPULP_LB_POST("t0", "96", "%[p]")  XPULP_LB_POST("t1", "1", "%[w]") \
  XPULP_MAC("%[sum]", "t2", "t3")                                     \
  XPULP_MAC("%[sum]", "t0", "t1")
// clang-format on

void convolution_scalar(const job_t* shared, unsigned core) {
  const job_t job = *shared;  // copies the job, which is in L2
  const unsigned end = first_of(kOut, &job, core + 1);
  for (unsigned y = first_of(kOut, &job, core); y < end; ++y) {
    int8_t* out = job.out + y * kOut;
    for (unsigned x = 0; x < kOut; ++x) {
      int32_t sum = 0;
      const int8_t* p = job.pixels + y * kWidth + x;
      const int8_t* w = job.weights;
      __asm__ volatile(XPULP_LOOP("x0", "%[n]", "15") TAPS_OF_A_ROW XPULP_LOOP_END
                       : [sum] "+r"(sum), [p] "+r"(p), [w] "+r"(w)
                       : [n] "r"(5)
                       : "t0", "t1", "t2", "t3", "memory");
      xpulp_sb_post(out, 1, xpulp_clip(sum >> SHIFT, 8));
    }
  }
}

// Computes the outputs column by column, from top to bottom. An output needs 5 x 5 pixels. Their first four rows stay
// in registers (four words and four bytes); only the fifth row is loaded: a word and a byte.
void convolution_vector(const job_t* shared, unsigned core) {
  const job_t job = *shared;  // copies the job, which is in L2
  const unsigned begin = first_of(kOut, &job, core);
  const unsigned end = first_of(kOut, &job, core + 1);
  const xpulp_word* const w = (const xpulp_word*)job.weights;
  const uint32_t w0 = w[0], w1 = w[1], w2 = w[2], w3 = w[3], w4 = w[4];  // words of four columns for each row
  const uint32_t w_last = w[5];                                          // bytes of the fifth column for rows 0 to 3
  const int32_t w_corner = job.weights[24];
  const uint32_t next_byte = 0x04030201;  // shuffle2: bytes 1 to 3 of one word, and the low byte of the other
  for (unsigned x = 0; x < kOut; ++x) {
    const int8_t* p = job.pixels + begin * kWidth + x;
    const int8_t* q = p + 4;
    int8_t* out = job.out + begin * kOut + x;
    uint32_t r0 = xpulp_lw_post(p, kWidth), r1 = xpulp_lw_post(p, kWidth);
    uint32_t r2 = xpulp_lw_post(p, kWidth), r3 = xpulp_lw_post(p, kWidth);
    uint32_t last = (uint8_t)q[0] | (uint32_t)(uint8_t)q[kWidth] << 8 | (uint32_t)(uint8_t)q[2 * kWidth] << 16 |
                    (uint32_t)(uint8_t)q[3 * kWidth] << 24;
    q += 4 * kWidth;
    // Unrolls the loop four times, so that no word moves between registers.
#pragma GCC unroll 4
    for (unsigned y = begin; y < end; ++y) {
      const uint32_t r4 = xpulp_lw_post(p, kWidth);
      const int32_t corner = xpulp_lb_post(q, kWidth);
      int32_t sum = xpulp_sdotsp_b(0, r0, w0);
      sum = xpulp_sdotsp_b(sum, r1, w1);
      sum = xpulp_sdotsp_b(sum, r2, w2);
      sum = xpulp_sdotsp_b(sum, r3, w3);
      sum = xpulp_sdotsp_b(sum, r4, w4);
      sum = xpulp_sdotsp_b(sum, last, w_last);
      sum = xpulp_mac(sum, (uint32_t)corner, (uint32_t)w_corner);
      last = xpulp_shuffle2_b((uint32_t)last, (uint32_t)corner, next_byte);
      r0 = r1;
      r1 = r2;
      r2 = r3;
      r3 = r4;
      xpulp_sb_post(out, kOut, xpulp_clip(sum >> SHIFT, 8));
    }
  }
}

// Two products with their loads. The second product directly follows the load of its operand, so it waits one cycle.
// With this wait, the kernel takes as many cycles as GreenWaves' published kernel.
// clang-format off
#define PRODUCT_PAIR(load, product, step)                                    \
  load("t0", step, "%[p]") load("t1", step, "%[w]") load("t2", step, "%[p]") \
  product("%[sum]", "t0", "t1") load("t3", step, "%[w]") product("%[sum]", "t2", "t3")
// clang-format on

void linear_plain(const job_t* shared, unsigned core) {
  const job_t job = *shared;  // copies the job, which is in L2
  const unsigned end = first_of(kOutputs, &job, core + 1);
  for (unsigned output = first_of(kOutputs, &job, core); output < end; ++output) {
    int32_t sum = 0;
    for (unsigned i = 0; i < kInputs; ++i) sum += job.pixels[i] * job.weights[output * kInputs + i];
    job.sums[output] = sum;
  }
}

// Implements the scalar and the vector form of the linear layer. They load 1 and 4 bytes at a time.
// clang-format off
#define LINEAR(name, load, product, bytes)                                                                     \
  void name(const job_t* shared, unsigned core) {                                                              \
    const job_t job = *shared; /* it lies in L2 */                                                             \
    const unsigned end = first_of(kOutputs, &job, core + 1);                                                   \
    for (unsigned output = first_of(kOutputs, &job, core); output < end; ++output) {                           \
      int32_t sum = 0;                                                                                         \
      const int8_t* p = job.pixels;                                                                            \
      const int8_t* w = job.weights + output * kInputs;                                                        \
      __asm__ volatile(XPULP_LOOP("x0", "%[n]", "6") PRODUCT_PAIR(load, product, #bytes) XPULP_LOOP_END        \
                       : [sum] "+r"(sum), [p] "+r"(p), [w] "+r"(w)                                             \
                       : [n] "r"(kInputs / (2 * (bytes)))                                                     \
                       : "t0", "t1", "t2", "t3", "memory");                                                    \
      job.sums[output] = sum;                                                                                  \
    }                                                                                                          \
  }
// clang-format on
LINEAR(linear_scalar, XPULP_LB_POST, XPULP_MAC, 1)
LINEAR(linear_vector, XPULP_LW_POST, XPULP_SDOTSP_B, 4)

void pool_plain(const job_t* shared, unsigned core) {
  const job_t job = *shared;  // copies the job, which is in L2
  const unsigned end = first_of(kPooled, &job, core + 1);
  for (unsigned y = first_of(kPooled, &job, core); y < end; ++y) {
    for (unsigned x = 0; x < kPooled; ++x) {
      const int8_t* top = job.pixels + 2 * (y * kPixels + x);
      const int8_t left = top[0] > top[kPixels] ? top[0] : top[kPixels];
      const int8_t right = top[1] > top[kPixels + 1] ? top[1] : top[kPixels + 1];
      job.out[y * kPooled + x] = left > right ? left : right;
    }
  }
}

void pool_scalar(const job_t* shared, unsigned core) {
  const job_t job = *shared;  // copies the job, which is in L2
  const unsigned end = first_of(kPooled, &job, core + 1);
  for (unsigned y = first_of(kPooled, &job, core); y < end; ++y) {
    const int8_t* top = job.pixels + 2 * y * kPixels;
    const int8_t* bottom = top + kPixels;
    int8_t* out = job.out + y * kPooled;
    for (unsigned x = 0; x < kPooled; ++x) {
      const int32_t a = xpulp_lb_post(top, 1), b = xpulp_lb_post(bottom, 1);
      const int32_t c = xpulp_lb_post(top, 1), d = xpulp_lb_post(bottom, 1);
      const int32_t left = xpulp_max((uint32_t)a, (uint32_t)b);
      xpulp_sb_post(out, 1, xpulp_max((uint32_t)left, (uint32_t)xpulp_max((uint32_t)c, (uint32_t)d)));
    }
  }
}

void pool_vector(const job_t* shared, unsigned core) {
  const job_t job = *shared;  // copies the job, which is in L2
  const unsigned end = first_of(kPooled, &job, core + 1);
  for (unsigned y = first_of(kPooled, &job, core); y < end; ++y) {
    const int8_t* top = job.pixels + 2 * y * kPixels;
    const int8_t* bottom = top + kPixels;
    int8_t* out = job.out + y * kPooled;
    for (unsigned x = 0; x < kPooled; x += 4) {
      const uint32_t a = xpulp_lw_post(top, 4), b = xpulp_lw_post(top, 4);
      const uint32_t c = xpulp_lw_post(bottom, 4), d = xpulp_lw_post(bottom, 4);
      const uint32_t low = xpulp_max_b(a, c), high = xpulp_max_b(b, d);
      const uint32_t even = xpulp_shuffle2_b(low, high, 0x06040200), odd = xpulp_shuffle2_b(low, high, 0x07050301);
      xpulp_sw_post(out, 4, xpulp_max_b(even, odd));
    }
  }
}

// Implements the scalar and the vector form of the average pool. They take 8 and 7 cycles per output pixel, as
// GreenWaves published.
// clang-format off
#define AVERAGE(name, instructions, body)                                                                    \
  void name(const job_t* shared, unsigned core) {                                                            \
    const job_t job = *shared; /* it lies in L2 */                                                           \
    const unsigned end = first_of(kPooled, &job, core + 1);                                                  \
    for (unsigned y = first_of(kPooled, &job, core); y < end; ++y) {                                         \
      const int8_t* top = job.pixels + 2 * y * kPixels;                                                      \
      const int8_t* bottom = top + kPixels;                                                                  \
      int8_t* out = job.out + y * kPooled;                                                                   \
      __asm__ volatile(XPULP_LOOP("x0", "%[n]", instructions) body XPULP_SB_POST("t0", "1", "%[out]") XPULP_LOOP_END \
                       : [top] "+r"(top), [bottom] "+r"(bottom), [out] "+r"(out)                             \
                       : [n] "r"(kPooled), [halves] "r"(0x05040100), [ones] "r"(0x01010101)                  \
                       : "t0", "t1", "t2", "t3", "memory");                                                  \
    }                                                                                                        \
  }
AVERAGE(average_scalar, "8",
        XPULP_LB_POST("t0", "1", "%[top]") XPULP_LB_POST("t1", "1", "%[top]")
        XPULP_LB_POST("t2", "1", "%[bottom]") XPULP_LB_POST("t3", "1", "%[bottom]")
        "add t0, t0, t1\n\t" "add t2, t2, t3\n\t" ".insn r 0x5b, 2, 2, t0, t0, t2\n\t" /* p.addN: >> 2 */)
// Loads the two pixels of each row as a halfword. shuffle2 joins the two halfwords to a word; it waits one cycle for
// the load directly before it.
AVERAGE(average_vector, "6",
        XPULP_LH_POST("t0", "2", "%[top]") XPULP_LH_POST("t1", "2", "%[bottom]")
        ".insn r 0x57, 1, 0x64, t0, t1, %[halves]\n\t" /* pv.shuffle2.b */
        ".insn r 0x57, 1, 0x4c, t0, t0, %[ones]\n\t" /* pv.dotsp.b */ "srai t0, t0, 2\n\t")
// clang-format on

static unsigned bit_of(const int8_t* bits, unsigned at) {
  return (uint8_t)bits[at / 8] >> at % 8 & 1;
}

// For each output, counts the input bits in its 5 x 5 window that equal the filter's bits.
void xnor_plain(const job_t* shared, unsigned core) {
  const job_t job = *shared;  // copies the job, which is in L2
  const unsigned end = first_of(kOut, &job, core + 1);
  for (unsigned y = first_of(kOut, &job, core); y < end; ++y) {
    for (unsigned x = 0; x < kOut; ++x) {
      unsigned same = 0;
      for (unsigned row = 0; row < 5; ++row) {
        for (unsigned column = 0; column < 5; ++column) {
          same += bit_of(job.pixels, (y + row) * kWidth + x + column) == bit_of(job.weights, row * 5 + column);
        }
      }
      job.out[y * kOut + x] = (int8_t)same;
    }
  }
}

// Returns six bits from the bit address `at` on.
static uint32_t six_bits(const int8_t* bits, unsigned at) {
  const xpulp_half half = *(const xpulp_half*)(bits + at / 8);
  return (uint32_t)half >> at % 8 & 63;
}

// Computes the outputs of two adjacent columns at a time, from top to bottom. `window` contains the input bits of both
// outputs: five rows of six bits. Each step shifts one more row into it.
void xnor_scalar(const job_t* shared, unsigned core) {
  const job_t job = *shared;  // copies the job, which is in L2
  const unsigned end = first_of(kOut / 2, &job, core + 1);
  uint32_t filter = 0;
  for (unsigned i = 0; i < kTaps; ++i) filter |= bit_of(job.weights, i) << (i / 5 * 6 + i % 5);
  const uint32_t five_of_six = 0x1f7df7df;
  for (unsigned pair = first_of(kOut / 2, &job, core); pair < end; ++pair) {
    unsigned at = 2 * pair;
    int8_t* out = job.out + at;
    uint32_t window = 0;
    for (unsigned row = 0; row < 4; ++row, at += kWidth) window = window >> 6 | six_bits(job.pixels, at) << 24;
    for (unsigned y = 0; y < kOut; ++y, at += kWidth) {
      window = window >> 6 | six_bits(job.pixels, at) << 24;
      const uint32_t left = xpulp_cnt(~(window ^ filter) & five_of_six);
      const uint32_t right = xpulp_cnt(~(window >> 1 ^ filter) & five_of_six);
      xpulp_sh_post(out, kOut, left | right << 8);
    }
  }
}
