# SPDX-License-Identifier: Apache-2.0
# Computes pixels of a row of the network's picture, four per iteration, without stalls after loads:
#   void nn_hand_shrink_pixels(const uint16_t* columns, const uint8_t* upper, const uint8_t* lower, int8_t* to, int fours)
# Each pixel is the rounded mean of two pixels of the upper row and two of the lower row, starting at its source column,
# minus 128.

.macro p.lhu_post rd, step, rs
    .insn i 0x0b, 5, \rd, \rs, \step
.endm
.macro p.lhu_at rd, base, offset
    .insn r 0x03, 7, 0x28, \rd, \base, \offset
.endm
.macro p.sb_post rs2, step, rs1
    .insn s 0x2b, 0, \rs2, \step(\rs1)
.endm
.macro pv.pack.h rd, rs1, rs2
    .insn r 0x57, 0, 0x68, \rd, \rs1, \rs2
.endm
.macro pv.dotup.b rd, rs1, rs2
    .insn r 0x57, 1, 0x40, \rd, \rs1, \rs2
.endm
# (rs1 + rs2 + 2) >> 2
.macro p.addRN2 rd, rs1, rs2
    .insn r 0x5b, 6, 2, \rd, \rs1, \rs2
.endm

    .text
    .balign 16
    .globl nn_hand_shrink_pixels
    .type nn_hand_shrink_pixels, @function
nn_hand_shrink_pixels:
    .option push
    .option norvc
    li a7, 0x01010101
    li a6, -4 * 128
    .balign 4
    .insn i 0x7b, 4, x0, a4, 2 * 28
    p.lhu_post t0, 2, a0
    p.lhu_post t1, 2, a0
    p.lhu_post t2, 2, a0
    p.lhu_post t3, 2, a0
    p.lhu_at t4, a1, t0
    p.lhu_at t0, a2, t0
    p.lhu_at t5, a1, t1
    p.lhu_at t1, a2, t1
    p.lhu_at t6, a1, t2
    p.lhu_at t2, a2, t2
    p.lhu_at a5, a1, t3
    p.lhu_at t3, a2, t3
    pv.pack.h t0, t4, t0
    pv.pack.h t1, t5, t1
    pv.pack.h t2, t6, t2
    pv.pack.h t3, a5, t3
    pv.dotup.b t0, t0, a7
    pv.dotup.b t1, t1, a7
    pv.dotup.b t2, t2, a7
    pv.dotup.b t3, t3, a7
    p.addRN2 t0, t0, a6
    p.addRN2 t1, t1, a6
    p.addRN2 t2, t2, a6
    p.addRN2 t3, t3, a6
    p.sb_post t0, 1, a3
    p.sb_post t1, 1, a3
    p.sb_post t2, 1, a3
    p.sb_post t3, 1, a3
    .option pop
    ret
    .size nn_hand_shrink_pixels, . - nn_hand_shrink_pixels
