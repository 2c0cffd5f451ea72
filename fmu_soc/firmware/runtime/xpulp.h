// SPDX-License-Identifier: Apache-2.0
//
// Xpulp v2 instructions of RI5CY (GAP8's cores) that kernels need, for a compiler that does not support them. Each
// function is one instruction of one cycle. On a core without Xpulp, the instruction is illegal.
//
// A word contains two halves or four bytes; part 0 is the lowest. The names are those of the manual: xpulp_sdotsp_b is
// pv.sdotsp.b. Arguments named `shift`, `bits`, `position`, `width`, `part`, `step` must be constants.
//
//   int32_t sum = 0;
//   for (int i = 0; i < n; i += 4) {
//     const uint32_t w = xpulp_lw_post(weights, 4);     // weights += 4 bytes
//     const uint32_t x = xpulp_lw_post(pixels, 4);
//     sum = xpulp_sdotsp_b(sum, w, x);
//   }
//
// A hardware loop must be a complete asm block, because gcc does not know that the loop jumps back:
//
//   __asm__ volatile(XPULP_LOOP("x0", "%[n]", "3")     // three instructions, n times
//                    XPULP_LW_POST("t0", "4", "%[w]")
//                    XPULP_LW_POST("t1", "4", "%[x]")
//                    XPULP_SDOTSP_B("%[sum]", "t0", "t1")
//                    XPULP_LOOP_END
//                    : [sum] "+r"(sum), [w] "+r"(weights), [x] "+r"(pixels) : [n] "r"(n / 4) : "t0", "t1", "memory");
//
// The body must have no jump, branch or compressed instruction; n = 0 runs it once, like n = 1. Loop x0 may be in the
// body of loop x1, but not at its last instruction.
#pragma once

#include <stdint.h>

// --- Parts of asm blocks --------------------------------------------------------------------------------------------

/// Repeats the next `body` instructions (a number in quotes, up to 2047) `count` (register) times. loop: "x0" or "x1".
#define XPULP_LOOP(loop, count, body) \
  ".balign 4\n\t.option push\n\t.option norvc\n\t.insn i 0x7b, 4, " loop ", " count ", 2 * " body "\n\t"
#define XPULP_LOOP_END ".option pop\n\t"

#define XPULP_LB_POST(rd, step, rs1) ".insn i 0x0b, 0, " rd ", " rs1 ", " step "\n\t"
#define XPULP_LH_POST(rd, step, rs1) ".insn i 0x0b, 1, " rd ", " rs1 ", " step "\n\t"
#define XPULP_LW_POST(rd, step, rs1) ".insn i 0x0b, 2, " rd ", " rs1 ", " step "\n\t"
#define XPULP_LBU_POST(rd, step, rs1) ".insn i 0x0b, 4, " rd ", " rs1 ", " step "\n\t"
#define XPULP_LHU_POST(rd, step, rs1) ".insn i 0x0b, 5, " rd ", " rs1 ", " step "\n\t"
#define XPULP_LW_POST_REG(rd, rs2, rs1) ".insn r 0x0b, 7, 0x10, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_SB_POST(rs2, step, rs1) ".insn s 0x2b, 0, " rs2 ", " step "(" rs1 ")\n\t"
#define XPULP_SH_POST(rs2, step, rs1) ".insn s 0x2b, 1, " rs2 ", " step "(" rs1 ")\n\t"
#define XPULP_SW_POST(rs2, step, rs1) ".insn s 0x2b, 2, " rs2 ", " step "(" rs1 ")\n\t"

#define XPULP_SB_POST_REG(rs2, step, rs1) ".insn r 0x2b, 4, 0x00, " step ", " rs1 ", " rs2 "\n\t"
#define XPULP_SW_POST_REG(rs2, step, rs1) ".insn r 0x2b, 6, 0x00, " step ", " rs1 ", " rs2 "\n\t"

#define XPULP_DOTUSP_B(rd, rs1, rs2) ".insn r 0x57, 1, 0x44, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_SDOTUP_B(rd, rs1, rs2) ".insn r 0x57, 1, 0x50, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_SDOTUSP_B(rd, rs1, rs2) ".insn r 0x57, 1, 0x54, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_SDOTSP_B(rd, rs1, rs2) ".insn r 0x57, 1, 0x5c, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_SDOTSP_H(rd, rs1, rs2) ".insn r 0x57, 0, 0x5c, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_MAC(rd, rs1, rs2) ".insn r 0x33, 0, 0x21, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_MIN(rd, rs1, rs2) ".insn r 0x33, 4, 0x02, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_MAX(rd, rs1, rs2) ".insn r 0x33, 6, 0x02, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_CLIPUR(rd, rs1, rs2) ".insn r 0x33, 6, 0x0a, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_ADDNR(rd, rs1, rs2) ".insn r 0x5b, 2, 0x20, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_SHUFFLE2_B(rd, rs1, rs2) ".insn r 0x57, 1, 0x64, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_SHUFFLE2_H(rd, rs1, rs2) ".insn r 0x57, 0, 0x64, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_PACKHI_B(rd, rs1, rs2) ".insn r 0x57, 1, 0x6c, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_PACKLO_B(rd, rs1, rs2) ".insn r 0x57, 1, 0x70, " rd ", " rs1 ", " rs2 "\n\t"
#define XPULP_PACK_H(rd, rs1, rs2) ".insn r 0x57, 0, 0x68, " rd ", " rs1 ", " rs2 "\n\t"

// --- Post-increment loads and stores --------------------------------------------------------------------------------
// `pointer` must be a pointer variable. It is incremented by `step` bytes (-2048 to 2047), independent of its type.

typedef uint32_t __attribute__((may_alias)) xpulp_word;
typedef uint16_t __attribute__((may_alias)) xpulp_half;
typedef uint8_t __attribute__((may_alias)) xpulp_byte;

#define XPULP_POST_LOAD_(type, memory, name, pointer, step) \
  (__extension__({                                          \
    type value_;                                            \
    __asm__(XPULP_##name##_POST("%0", "%2", "%1")           \
            : "=&r"(value_), "+r"(pointer)                  \
            : "i"(step), "m"(*(const memory*)(pointer)));   \
    value_;                                                 \
  }))
#define XPULP_POST_STORE_(memory, name, pointer, step, value)   \
  (__extension__({                                              \
    __asm__ volatile(XPULP_##name##_POST("%2", "%3", "%0")      \
                     : "+r"(pointer), "=m"(*(memory*)(pointer)) \
                     : "r"(value), "i"(step));                  \
  }))

#define xpulp_lb_post(pointer, step) XPULP_POST_LOAD_(int32_t, xpulp_byte, LB, pointer, step)
#define xpulp_lbu_post(pointer, step) XPULP_POST_LOAD_(uint32_t, xpulp_byte, LBU, pointer, step)
#define xpulp_lh_post(pointer, step) XPULP_POST_LOAD_(int32_t, xpulp_half, LH, pointer, step)
#define xpulp_lhu_post(pointer, step) XPULP_POST_LOAD_(uint32_t, xpulp_half, LHU, pointer, step)
#define xpulp_lw_post(pointer, step) XPULP_POST_LOAD_(uint32_t, xpulp_word, LW, pointer, step)
#define xpulp_sb_post(pointer, step, value) XPULP_POST_STORE_(xpulp_byte, SB, pointer, step, value)
#define xpulp_sh_post(pointer, step, value) XPULP_POST_STORE_(xpulp_half, SH, pointer, step, value)
#define xpulp_sw_post(pointer, step, value) XPULP_POST_STORE_(xpulp_word, SW, pointer, step, value)

// --- One instruction per function -----------------------------------------------------------------------------------

#define XPULP_UNARY_(name, opcode, funct3, funct7)                                           \
  static inline uint32_t xpulp_##name(uint32_t a) {                                          \
    uint32_t d;                                                                              \
    __asm__(".insn r " #opcode ", " #funct3 ", " #funct7 ", %0, %1, x0" : "=r"(d) : "r"(a)); \
    return d;                                                                                \
  }
#define XPULP_BINARY_(name, opcode, funct3, funct7)                                                  \
  static inline uint32_t xpulp_##name(uint32_t a, uint32_t b) {                                      \
    uint32_t d;                                                                                      \
    __asm__(".insn r " #opcode ", " #funct3 ", " #funct7 ", %0, %1, %2" : "=r"(d) : "r"(a), "r"(b)); \
    return d;                                                                                        \
  }
#define XPULP_SIGNED_(name, opcode, funct3, funct7)                                                  \
  static inline int32_t xpulp_##name(int32_t a, int32_t b) {                                         \
    int32_t d;                                                                                       \
    __asm__(".insn r " #opcode ", " #funct3 ", " #funct7 ", %0, %1, %2" : "=r"(d) : "r"(a), "r"(b)); \
    return d;                                                                                        \
  }
/// `into` is an operand as well as the result.
#define XPULP_INTO_(name, type, opcode, funct3, funct7)                                                 \
  static inline type xpulp_##name(type into, uint32_t a, uint32_t b) {                                  \
    __asm__(".insn r " #opcode ", " #funct3 ", " #funct7 ", %0, %1, %2" : "+r"(into) : "r"(a), "r"(b)); \
    return into;                                                                                        \
  }

// Scalar
XPULP_SIGNED_(min, 0x33, 4, 0x02)
XPULP_SIGNED_(max, 0x33, 6, 0x02)
XPULP_BINARY_(minu, 0x33, 5, 0x02)
XPULP_BINARY_(maxu, 0x33, 7, 0x02)
XPULP_UNARY_(abs, 0x33, 0, 0x02)
XPULP_SIGNED_(clipr, 0x33, 5, 0x0a)   // into [-b - 1, b]
XPULP_SIGNED_(clipur, 0x33, 6, 0x0a)  // into [0, b]
XPULP_UNARY_(ff1, 0x33, 0, 0x08)
XPULP_UNARY_(fl1, 0x33, 1, 0x08)
XPULP_UNARY_(clb, 0x33, 2, 0x08)
XPULP_UNARY_(cnt, 0x33, 3, 0x08)
XPULP_BINARY_(ror, 0x33, 5, 0x04)
XPULP_INTO_(mac, int32_t, 0x33, 0, 0x21)  // into + a * b
XPULP_INTO_(msu, int32_t, 0x33, 1, 0x21)  // into - a * b

// Return (into + a) >> b. addRNr rounds.
XPULP_INTO_(addNr, int32_t, 0x5b, 2, 0x20)
XPULP_INTO_(addRNr, int32_t, 0x5b, 6, 0x20)

// Dot products of bytes (b) and halves (h). Operands are unsigned (u), signed (s), or `a` unsigned and `b` signed (us).
// sdot adds the product to `into`.
XPULP_BINARY_(dotup_b, 0x57, 1, 0x40)
XPULP_BINARY_(dotup_h, 0x57, 0, 0x40)
XPULP_BINARY_(dotusp_b, 0x57, 1, 0x44)
XPULP_BINARY_(dotusp_h, 0x57, 0, 0x44)
XPULP_BINARY_(dotsp_b, 0x57, 1, 0x4c)
XPULP_BINARY_(dotsp_h, 0x57, 0, 0x4c)
XPULP_INTO_(sdotup_b, int32_t, 0x57, 1, 0x50)
XPULP_INTO_(sdotup_h, int32_t, 0x57, 0, 0x50)
XPULP_INTO_(sdotusp_b, int32_t, 0x57, 1, 0x54)
XPULP_INTO_(sdotusp_h, int32_t, 0x57, 0, 0x54)
XPULP_INTO_(sdotsp_b, int32_t, 0x57, 1, 0x5c)
XPULP_INTO_(sdotsp_h, int32_t, 0x57, 0, 0x5c)

// Operations on pairs of parts. With _sc, the second operand is the lowest part of `b` for all parts.
XPULP_BINARY_(add_b, 0x57, 1, 0x00)
XPULP_BINARY_(add_h, 0x57, 0, 0x00)
XPULP_BINARY_(sub_b, 0x57, 1, 0x04)
XPULP_BINARY_(sub_h, 0x57, 0, 0x04)
XPULP_BINARY_(avgu_b, 0x57, 1, 0x0c)
XPULP_BINARY_(avg_h, 0x57, 0, 0x08)
XPULP_BINARY_(min_b, 0x57, 1, 0x10)
XPULP_BINARY_(min_h, 0x57, 0, 0x10)
XPULP_BINARY_(max_b, 0x57, 1, 0x18)
XPULP_BINARY_(max_h, 0x57, 0, 0x18)
XPULP_BINARY_(maxu_b, 0x57, 1, 0x1c)
XPULP_BINARY_(max_sc_b, 0x57, 5, 0x18)
XPULP_BINARY_(max_sc_h, 0x57, 4, 0x18)
XPULP_BINARY_(min_sc_h, 0x57, 4, 0x10)
XPULP_BINARY_(add_sc_h, 0x57, 4, 0x00)
XPULP_BINARY_(sra_sc_h, 0x57, 4, 0x24)
XPULP_BINARY_(srl_sc_b, 0x57, 5, 0x20)

// Permutations of parts
XPULP_BINARY_(shuffle_b, 0x57, 1, 0x60)  // each part of b selects a part of a
XPULP_BINARY_(shuffle_h, 0x57, 0, 0x60)
XPULP_INTO_(shuffle2_b, uint32_t, 0x57, 1, 0x64)  // b selects parts of into (0 to 3) and a (4 to 7)
XPULP_INTO_(shuffle2_h, uint32_t, 0x57, 0, 0x64)  // halves: 0 and 1 of into, 2 and 3 of a
XPULP_BINARY_(pack, 0x57, 0, 0x68)                // low half of a in the upper half, that of b in the lower half
XPULP_INTO_(packhi_b, uint32_t, 0x57, 1, 0x6c)    // low bytes of a and b in the upper half of into
XPULP_INTO_(packlo_b, uint32_t, 0x57, 1, 0x70)    // low bytes of a and b in the lower half of into

// With constants
#define XPULP_CONSTANT_(type, opcode, funct3, funct7, a, rs2)                                                     \
  (__extension__({                                                                                                \
    type result_;                                                                                                 \
    __asm__(".insn r " #opcode ", " #funct3 ", %3, %0, %1, x%2" : "=r"(result_) : "r"(a), "i"(rs2), "i"(funct7)); \
    result_;                                                                                                      \
  }))
#define XPULP_SHIFTED_(type, opcode, funct3, top, a, b, shift) \
  (__extension__({                                             \
    type result_;                                              \
    __asm__(".insn r " #opcode ", " #funct3 ", %3, %0, %1, %2" \
            : "=r"(result_)                                    \
            : "r"(a), "r"(b), "i"((top) + (shift)));           \
    result_;                                                   \
  }))

/// Limits `a` to [-2^(bits-1), 2^(bits-1) - 1] or, for clipu, to [0, 2^(bits-1) - 1]. `bits` is from 1 to 31.
#define xpulp_clip(a, bits) XPULP_CONSTANT_(int32_t, 0x33, 1, 0x0a, (int32_t)(a), bits)
#define xpulp_clipu(a, bits) XPULP_CONSTANT_(int32_t, 0x33, 2, 0x0a, (int32_t)(a), bits)
/// Extracts `width` bits from `position`, with sign or zero extension.
#define xpulp_extract(a, width, position) XPULP_CONSTANT_(int32_t, 0x33, 0, 0x60 + (width)-1, (uint32_t)(a), position)
#define xpulp_extractu(a, width, position) XPULP_CONSTANT_(uint32_t, 0x33, 1, 0x60 + (width)-1, (uint32_t)(a), position)
/// Sum or difference, shifted right arithmetically. RN adds 2^(shift-1) before the shift, which rounds to the nearest.
#define xpulp_addN(a, b, shift) XPULP_SHIFTED_(int32_t, 0x5b, 2, 0x00, (int32_t)(a), (int32_t)(b), shift)
#define xpulp_addRN(a, b, shift) XPULP_SHIFTED_(int32_t, 0x5b, 6, 0x00, (int32_t)(a), (int32_t)(b), shift)
#define xpulp_subRN(a, b, shift) XPULP_SHIFTED_(int32_t, 0x5b, 7, 0x00, (int32_t)(a), (int32_t)(b), shift)
/// Product of the low signed halves (hh: of the high ones), rounded and shifted right by `shift`.
#define xpulp_mulsRN(a, b, shift) XPULP_SHIFTED_(int32_t, 0x5b, 4, 0x40, (int32_t)(a), (int32_t)(b), shift)
#define xpulp_mulhhsRN(a, b, shift) XPULP_SHIFTED_(int32_t, 0x5b, 4, 0x60, (int32_t)(a), (int32_t)(b), shift)
