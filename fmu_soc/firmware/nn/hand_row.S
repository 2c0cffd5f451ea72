# SPDX-License-Identifier: Apache-2.0
# Computes `count` pooled positions of a row of the first layer (5 x 5 with stride 2, then 2 x 2 pooling), for four
# channels.
#   void nn_hand_row(const uint8_t* at, uint8_t* to, const uint32_t* table, int count)
# `at` points to the patch of the first position, in rows of NN_HAND_PITCH bytes. For each position, `at` advances by 4
# bytes and `to` by NN_CHANNELS_FIRST bytes. `table` has NN_HAND_WORDS words per channel (see make_table).
#
# The four positions of a pool share a patch of 7 x 7 pixels in 20 registers. For each row, there are pixels 0 to 3 (for
# the left positions) and pixels 2 to 5 (for the right positions). The fifth pixels of the rows are gathered. Two
# registers contain rows 4 and 6 from pixel 4 on; bytes 0 and 2 are the last pixels. So each weight is loaded once for
# four dot products, and no register is spilled.
#include "nn/hand.h"

# Pixels 0 to 3 of rows 0 to 6
#define L0 x5
#define L1 x6
#define L2 x7
#define L3 x8
#define L4 x9
#define L5 x18
#define L6 x19
# Pixels 2 to 5
#define Q0 x20
#define Q1 x21
#define Q2 x22
#define Q3 x23
#define Q4 x24
#define Q5 x25
#define Q6 x26
# Fifth pixels of rows 0 to 3 and of rows 2 to 5: for the left positions (FL), for the right positions (FR)
#define FL0 x27
#define FL2 x28
#define FR0 x29
#define FR2 x30
# Pixels 4 to 7
#define R4 x31
#define R6 x1
# Sums of four positions: left (L) or right (R), upper (U) or lower (L)
#define LU x13
#define LL x14
#define RU x15
#define RL x16
#define W0 x17
#define W1 x3
#define MASK x4
#define AT x10
#define TO x11
#define TABLE x12

.macro p.lw rd
    .insn i 0x0b, 2, \rd, TABLE, 4
.endm
.macro pv.dotsp.b rd, rs1, rs2
    .insn r 0x57, 1, 0x4c, \rd, \rs1, \rs2
.endm
.macro pv.sdotsp.b rd, rs1, rs2
    .insn r 0x57, 1, 0x5c, \rd, \rs1, \rs2
.endm
.macro pv.shuffle2.b rd, rs1, rs2
    .insn r 0x57, 1, 0x64, \rd, \rs1, \rs2
.endm
.macro pv.pack.h rd, rs1, rs2
    .insn r 0x57, 0, 0x68, \rd, \rs1, \rs2
.endm
.macro pv.pack.h.h rd, rs1, rs2
    .insn r 0x57, 6, 0x68, \rd, \rs1, \rs2
.endm
.macro p.max rd, rs1, rs2
    .insn r 0x33, 6, 0x02, \rd, \rs1, \rs2
.endm
.macro p.clipu255 rd, rs
    .insn r 0x33, 2, 0x0a, \rd, \rs, x9
.endm
.macro four_products product, w, left_upper, left_lower, right_upper, right_lower
    \product LU, \left_upper, \w
    \product LL, \left_lower, \w
    \product RU, \right_upper, \w
    \product RL, \right_lower, \w
.endm
# Loads a word of the table while the products of the previous word are computed.
.macro channel number
    p.lw W0
    p.lw W1
    four_products pv.dotsp.b, W0, L0, L2, Q0, Q2
    p.lw W0
    four_products pv.sdotsp.b, W1, L1, L3, Q1, Q3
    p.lw W1
    four_products pv.sdotsp.b, W0, L2, L4, Q2, Q4
    p.lw W0
    four_products pv.sdotsp.b, W1, L3, L5, Q3, Q5
    p.lw W1
    four_products pv.sdotsp.b, W0, L4, L6, Q4, Q6
    p.lw W0
    four_products pv.sdotsp.b, W1, FL0, FL2, FR0, FR2
    p.lw W1
    pv.sdotsp.b LU, R4, W0
    pv.sdotsp.b LL, R6, W0
    p.lw W0
    pv.sdotsp.b RU, R4, W1
    pv.sdotsp.b RL, R6, W1
    p.lw W1
    p.max LU, LU, LL
    p.max RU, RU, RL
    p.max LU, LU, RU
    add LU, LU, W0
    sra LU, LU, W1
    p.clipu255 LU, LU
    sb LU, \number(TO)
.endm

    .equ kTurn, 211                # instructions in the loop

    .text
    .balign 16
    .globl nn_hand_row
    .type nn_hand_row, @function
nn_hand_row:
    addi sp, sp, -64
    sw ra, 0(sp)
    sw gp, 4(sp)
    sw tp, 8(sp)
    sw s0, 12(sp)
    sw s1, 16(sp)
    .irp n, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11
    sw s\n, 12 + 4 * \n(sp)
    .endr
    .option push
    .option norvc
    li MASK, 0x02060004            # bytes 0 of a and of what it goes into, then bytes 2
    .balign 4
    .insn i 0x7b, 4, x0, a3, 2 * kTurn
1:  lw L0, 0 * NN_HAND_PITCH(AT)
    lw L1, 1 * NN_HAND_PITCH(AT)
    lw L2, 2 * NN_HAND_PITCH(AT)
    lw L3, 3 * NN_HAND_PITCH(AT)
    lw L4, 4 * NN_HAND_PITCH(AT)
    lw L5, 5 * NN_HAND_PITCH(AT)
    lw L6, 6 * NN_HAND_PITCH(AT)
    lw FL0, 0 * NN_HAND_PITCH + 4(AT)
    lw Q1, 1 * NN_HAND_PITCH + 4(AT)
    lw FL2, 2 * NN_HAND_PITCH + 4(AT)
    lw Q3, 3 * NN_HAND_PITCH + 4(AT)
    lw R4, 4 * NN_HAND_PITCH + 4(AT)
    lw Q5, 5 * NN_HAND_PITCH + 4(AT)
    lw R6, 6 * NN_HAND_PITCH + 4(AT)
    pv.shuffle2.b Q1, FL0, MASK
    pv.shuffle2.b Q3, FL2, MASK
    pv.shuffle2.b Q5, R4, MASK
    pv.pack.h FL0, Q3, Q1
    pv.pack.h.h FR0, Q3, Q1
    pv.pack.h FL2, Q5, Q3
    pv.pack.h.h FR2, Q5, Q3
    lw Q0, 0 * NN_HAND_PITCH + 2(AT)
    lw Q1, 1 * NN_HAND_PITCH + 2(AT)
    lw Q2, 2 * NN_HAND_PITCH + 2(AT)
    lw Q3, 3 * NN_HAND_PITCH + 2(AT)
    lw Q4, 4 * NN_HAND_PITCH + 2(AT)
    lw Q5, 5 * NN_HAND_PITCH + 2(AT)
    lw Q6, 6 * NN_HAND_PITCH + 2(AT)
    channel 0
    channel 1
    channel 2
    channel 3
    addi AT, AT, 4
    addi TABLE, TABLE, -4 * 4 * NN_HAND_WORDS
    addi TO, TO, NN_CHANNELS_FIRST
2:  .option pop
    .if (2b - 1b) != 4 * kTurn
    .error "kTurn is not the number of instructions of the loop"
    .endif
    lw ra, 0(sp)
    lw gp, 4(sp)
    lw tp, 8(sp)
    lw s0, 12(sp)
    lw s1, 16(sp)
    .irp n, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11
    lw s\n, 12 + 4 * \n(sp)
    .endr
    addi sp, sp, 64
    ret
    .size nn_hand_row, . - nn_hand_row
