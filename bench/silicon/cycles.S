# SPDX-License-Identifier: Apache-2.0
# The 18 rows of GreenWaves' CNN benchmark (gap_sdk, benchmarks/gap8/cnn) for GAP8, by its own registers: core 0 times
# RUNS runs of a kernel by the cluster's timer, alone, or with a team that the dispatcher forks and a barrier joins. The
# open PULP chip has the same registers, so that GVSoC runs the same program.
# Each kernel is new, written from what the benchmark computes and how it shares the work out: columns (rows of the
# linear layer) in equal parts, a column from top to bottom. One loop serves one core and eight, so what eight cores
# take follows from what one takes, and from fork, barrier and banks.
# It leaves cycles and a sum of the output for each row in the file "result", by semihosting; cycles.py prints them.

    .option norvc
    .option norelax

    .equ kEventUnit, 0x00204000    # a core's own, by the short way
    .equ kTimer, 0x00200400        # the cluster's
    .equ kMem, 0x10001000
    .equ kMemBytes, 55000
    .equ kJob, 0x1000F000          # input, filter, output, log2 of the cores
#ifndef RUNS
#define RUNS 100
#endif
    .equ kRuns, RUNS
    .equ kPixels, 112              # of pools: width and height
    .equ kPooled, kPixels / 2
    .equ kWidth, 100               # of convolutions, likewise: docs/chip/silicon.md tells why not 112
    .equ kOut, kWidth - 4
    .equ kInputs, 1024             # of the linear layer
    .equ kOutputs, 16
    .equ kNorm, 6

# --- Xpulp, for an assembler that does not know it ---
.macro p.lb rd, step, rs
    .insn i 0x0b, 0, \rd, \rs, \step
.endm
.macro p.lh rd, step, rs
    .insn i 0x0b, 1, \rd, \rs, \step
.endm
.macro p.lw rd, step, rs
    .insn i 0x0b, 2, \rd, \rs, \step
.endm
.macro p.sb rs2, step, rs1
    .insn s 0x2b, 0, \rs2, \step(\rs1)
.endm
.macro p.sh rs2, step, rs1
    .insn s 0x2b, 1, \rs2, \step(\rs1)
.endm
.macro p.max rd, rs1, rs2
    .insn r 0x33, 6, 0x02, \rd, \rs1, \rs2
.endm
.macro p.mac rd, rs1, rs2
    .insn r 0x33, 0, 0x21, \rd, \rs1, \rs2
.endm
.macro p.addN rd, rs1, rs2, shift
    .insn r 0x5b, 2, \shift, \rd, \rs1, \rs2
.endm
.macro p.cnt rd, rs
    .insn r 0x33, 3, 0x08, \rd, \rs, x0
.endm
.macro p.extract rd, rs, width, position
    .insn r 0x33, 0, 0x60 + \width - 1, \rd, \rs, x\position
.endm
.macro p.extractur rd, rs, field
    .insn r 0x33, 1, 0x40, \rd, \rs, \field
.endm
.macro p.insert rd, rs, width, position
    .insn r 0x33, 2, 0x60 + \width - 1, \rd, \rs, x\position
.endm
.macro pv.add.b rd, rs1, rs2
    .insn r 0x57, 1, 0x00, \rd, \rs1, \rs2
.endm
.macro pv.max.b rd, rs1, rs2
    .insn r 0x57, 1, 0x18, \rd, \rs1, \rs2
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
.macro pv.packhi.b rd, rs1, rs2
    .insn r 0x57, 1, 0x6c, \rd, \rs1, \rs2
.endm
.macro pv.packlo.b rd, rs1, rs2
    .insn r 0x57, 1, 0x70, \rd, \rs1, \rs2
.endm
.macro p.elw rd, offset, rs
    .insn i 0x03, 6, \rd, \offset(\rs)
.endm
.macro lp.setup loop, count, instructions
    .insn i 0x7b, 4, x\loop, \count, 2 * \instructions
.endm

# --- What kernels have in common ---

# Of the job at a0: s1 input, s2 filter, s3 output, s4 log2 of the cores; of `total` parts s5 are this core's, from t1 on.
.macro share total
    csrr t0, mhartid
    andi t0, t0, 31
    lw s1, 0(a0)
    lw s2, 4(a0)
    lw s3, 8(a0)
    lw s4, 12(a0)
    li s5, \total
    srl s5, s5, s4
    mul t1, s5, t0
.endm
# All of the team meet; one core alone has nobody to wait for.
.macro meet
    beqz s4, 9f
    li t0, kEventUnit
    p.elw t0, 0x21c, t0
9:  ret
.endm
.macro pool_begin
    share kPooled
    add s3, s3, t1
    slli t1, t1, 1
    add s1, s1, t1
    li s6, kPooled
.endm
.macro pool_end column
    addi s1, s1, 2
    addi s3, s3, 1
    addi s5, s5, -1
    bnez s5, \column
    meet
.endm

# --- Kernels ---

    .text
    .balign 16
max_pool:
    pool_begin
1:  mv a1, s1
    addi a2, s1, 1
    addi a3, s1, kPixels
    addi a4, s1, kPixels + 1
    mv a5, s3
    lp.setup 0, s6, 8
    p.lb t0, 2 * kPixels, a1
    p.lb t2, 2 * kPixels, a2
    p.lb t3, 2 * kPixels, a3
    p.lb t4, 2 * kPixels, a4
    p.max t0, t0, t2
    p.max t3, t3, t4
    p.max t0, t0, t3
    p.sb t0, kPooled, a5
    pool_end 1b

    .balign 16
average_pool:
    pool_begin
1:  mv a1, s1
    addi a2, s1, 1
    addi a3, s1, kPixels
    addi a4, s1, kPixels + 1
    mv a5, s3
    lp.setup 0, s6, 8
    p.lb t0, 2 * kPixels, a1
    p.lb t2, 2 * kPixels, a2
    p.lb t3, 2 * kPixels, a3
    p.lb t4, 2 * kPixels, a4
    add t0, t0, t2
    add t3, t3, t4
    p.addN t0, t0, t3, 2
    p.sb t0, kPooled, a5
    pool_end 1b

    .balign 16
max_pool_vector:
    pool_begin
1:  mv a1, s1
    addi a2, s1, kPixels
    mv a5, s3
    lp.setup 0, s6, 7
    p.lh t0, 2 * kPixels, a1
    p.lh t2, 2 * kPixels, a2
    pv.max.b t0, t0, t2            # waits a cycle for its load
    p.extract t2, t0, 8, 0
    p.extract t3, t0, 8, 8
    p.max t0, t2, t3
    p.sb t0, kPooled, a5
    pool_end 1b

    .balign 16
average_pool_vector:
    pool_begin
    li a6, 0x05040100              # bytes 0 and 1 of both
    li a7, 0x01010101
1:  mv a1, s1
    addi a2, s1, kPixels
    mv a5, s3
    lp.setup 0, s6, 6
    p.lh t0, 2 * kPixels, a1
    p.lh t2, 2 * kPixels, a2
    pv.shuffle2.b t0, t2, a6       # waits a cycle for its load
    pv.dotsp.b t0, t0, a7
    srai t0, t0, 2
    p.sb t0, kPooled, a5
    pool_end 1b

# The output keeps the input's width. A row of taps takes 18 cycles, of which three wait for a load: chosen so that one
# core's cycles come out.
    .balign 16
convolution:
    share kOut
    add s1, s1, t1
    add s3, s3, t1
    li s6, kOut
    li s7, 5
1:  mv a1, s1
    mv a2, s3
    lp.setup 1, s6, 23
    lb a5, 0(a2)
    mv a3, a1
    slli a5, a5, kNorm
    mv a4, s2
    lp.setup 0, s7, 15
    p.lb t0, 1, a3
    p.lb t2, 1, a4
    p.mac a5, t0, t2
    p.lb t3, 1, a3
    p.lb t4, 1, a4
    p.mac a5, t3, t4
    p.lb t0, 1, a3
    p.lb t2, 1, a4
    p.mac a5, t0, t2
    p.lb t3, 1, a3
    p.lb t4, 1, a4
    p.lb t0, kWidth - 4, a3
    p.lb t2, 1, a4
    p.mac a5, t3, t4
    p.mac a5, t0, t2
    addi a1, a1, kWidth
    srai a5, a5, kNorm
    p.sb a5, kWidth, a2
    addi s1, s1, 1
    addi s3, s3, 1
    addi s5, s5, -1
    bnez s5, 1b
    meet

# Runs down a column. A patch has four words of four pixels each, one word of fifth pixels, and one further fifth pixel.
    .balign 16
convolution_vector:
    share kOut
    add s1, s1, t1
    add s3, s3, t1
    lw a1, 0(s2)
    lw a2, 5(s2)
    lw a3, 10(s2)
    lw a4, 15(s2)
    lw a5, 20(s2)
    lb t2, 4(s2)
    lb t3, 9(s2)
    lb t4, 14(s2)
    lb t5, 19(s2)
    pv.packlo.b a6, t3, t2
    pv.packhi.b a6, t5, t4
    lbu a7, 24(s2)
    li s6, kOut
    li s7, 0x04030201
1:  mv t0, s1
    mv t1, s3
    p.lw s8, 4, t0
    p.lb t2, kWidth - 4, t0
    p.lw s9, 4, t0
    p.lb t3, kWidth - 4, t0
    p.lw s10, 4, t0
    p.lb t4, kWidth - 4, t0
    p.lw s11, 4, t0
    p.lb t5, kWidth - 4, t0
    pv.packlo.b t6, t3, t2
    pv.packhi.b t6, t5, t4
    lp.setup 0, s6, 18
    lb t2, 0(t1)
    p.lw t3, 4, t0                 # misaligned in three columns of four
    p.lb t4, kWidth - 4, t0
    slli t2, t2, kNorm
    pv.sdotsp.b t2, s8, a1
    pv.sdotsp.b t2, s9, a2
    pv.sdotsp.b t2, s10, a3
    pv.sdotsp.b t2, s11, a4
    pv.sdotsp.b t2, t3, a5
    pv.sdotsp.b t2, t6, a6
    pv.sdotsp.b t2, t4, a7
    mv s8, s9
    mv s9, s10
    mv s10, s11
    mv s11, t3
    pv.shuffle2.b t6, t4, s7
    srai t2, t2, kNorm
    p.sb t2, kOut, t1
    addi s1, s1, 1
    addi s3, s3, 1
    addi s5, s5, -1
    bnez s5, 1b
    meet

.macro product_pair load, product, step
    \load t2, \step, a1
    \load t3, \step, a2
    \load t4, \step, a1
    \product t0, t2, t3
    \load t5, \step, a2
    \product t0, t4, t5            # waits a cycle for its load
.endm
.macro linear_layer load, product, step, pairs, turns
    share kOutputs
    add s3, s3, t1
    slli t1, t1, 10
    add a2, s2, t1
    li s6, \turns
1:  lb t0, 0(s3)
    mv a1, s1
    slli t0, t0, kNorm
    lp.setup 0, s6, 6 * \pairs
    .rept \pairs
    product_pair \load, \product, \step
    .endr
    srai t0, t0, kNorm
    p.sb t0, 1, s3
    addi s5, s5, -1
    bnez s5, 1b
    meet
.endm

    .balign 16
linear:
    linear_layer p.lb, p.mac, 1, 2, kInputs / 4
    .balign 16
linear_vector:
    linear_layer p.lw, pv.sdotsp.b, 4, 1, kInputs / 8

# Bits, two columns at once: five rows of six in a word. At s1 and s2 are addresses of bits.
.macro six_bits position
    srli t2, a1, 3
    lhu t2, 0(t2)
    andi t3, a1, 7
    ori t3, t3, 5 << 5
    p.extractur t2, t2, t3
    p.insert a3, t2, 6, \position
    addi a1, a1, kWidth
.endm
    .balign 16
xnor:
    share kOut / 2
    slli t1, t1, 1
    add s1, s1, t1
    add s3, s3, t1
    srli s2, s2, 3
    lw t2, 0(s2)
    li a4, 0
    .irp row, 0, 1, 2, 3, 4
    srli t3, t2, 5 * \row
    andi t3, t3, 31
    slli t3, t3, 6 * \row
    or a4, a4, t3
    .endr
    li a5, 0x1F7DF7DF              # five bits of each six
    li s6, kOut
1:  mv a1, s1
    mv a2, s3
    li a3, 0
    six_bits 0
    six_bits 6
    six_bits 12
    six_bits 18
    srli a6, a1, 3
    lp.setup 0, s6, 22
    lhu t2, 0(a6)
    andi t3, a1, 7
    ori t3, t3, 5 << 5
    p.extractur t2, t2, t3
    p.insert a3, t2, 6, 24
    addi a1, a1, kWidth
    srli a6, a1, 3
    xor t2, a3, a4
    not t2, t2
    and t2, t2, a5
    p.cnt t2, t2
    srli t3, a3, 1
    xor t3, t3, a4
    not t3, t3
    and t3, t3, a5
    p.cnt t3, t3
    lhu t4, 0(a2)
    slli t3, t3, 8
    or t3, t3, t2
    pv.add.b t3, t3, t4
    p.sh t3, kOut, a2
    srli a3, a3, 6
    addi s1, s1, 2
    addi s3, s3, 2
    addi s5, s5, -1
    bnez s5, 1b
    meet

# --- The program ---

    .equ kStarted, 0xff            # cores of the cluster
    .include "cluster_boot.inc"
    .include "noise.inc"

core: li s0, kEventUnit
    li t0, 1 << 16 | 1 << 18       # barrier and dispatcher end a wait
    sw t0, 0x08(s0)
    beqz a0, master
4:  p.elw t0, 0x80, s0
    p.elw a0, 0x80, s0
    jalr t0
    p.elw t0, 0x21c, s0
    j 4b

master: la s11, begin_signature
    la s10, rows
5:  lw t0, 0(s10)
    beqz t0, 8f
    call prepare
    addi sp, s10, 0                # kernels use all s registers but s0
    mv gp, s11
    li tp, kRuns
    li t0, kTimer
    li t1, 3                       # on, from 0
    sw t1, 0(t0)
    lw a7, 8(t0)
    sw a7, 0(gp)
6:  li a0, kJob
    lw t0, 0(sp)
    lw t1, 20(sp)
    beqz t1, 7f
    li s0, kEventUnit              # a fork, as gap_sdk's runtime makes it
    li t2, 0xff
    sw t2, 0x84(s0)
    sw t2, 0x200(s0)
    sw t2, 0x20c(s0)
    sw t0, 0x80(s0)
    sw a0, 0x80(s0)
    jalr t0
    p.elw t0, 0x21c, s0
    addi tp, tp, -1
    bnez tp, 6b
    j 10f
7:  jalr t0
    addi tp, tp, -1
    bnez tp, 6b
10: li t0, kTimer
    lw t1, 8(t0)
    lw t2, 0(gp)
    sub t1, t1, t2
    mv s10, sp
    mv s11, gp
    sw t1, 0(s11)
    lw t0, 12(s10)                 # the sum of the output
    lw t1, 16(s10)
    li t2, 0
11: lbu t3, 0(t0)
    add t2, t2, t3
    addi t0, t0, 1
    addi t1, t1, -1
    bnez t1, 11b
    sw t2, 4(s11)
    addi s10, s10, 24
    addi s11, s11, 8
    j 5b
8:  la t0, done
    li t1, 1
    sw t1, 0(t0)
12: p.elw t0, 0x21c, s0            # for ever: it is alone at the barrier
    j 12b

# Prepares the job of the row at s10: fills the inputs with noise, and the output with zeros.
prepare:
    fill_noise kMem, kMemBytes
    lw t0, 12(s10)
    lw t1, 16(s10)
2:  sb zero, 0(t0)
    addi t0, t0, 1
    addi t1, t1, -1
    bnez t1, 2b
    li t0, kJob
    lw t1, 4(s10)
    sw t1, 0(t0)
    lw t1, 8(s10)
    sw t1, 4(t0)
    lw t1, 12(s10)
    sw t1, 8(t0)
    lw t1, 20(s10)
    sw t1, 12(t0)
    ret

# Kernel, input, filter, output and its bytes, log2 of the cores. Where things lie is the benchmark's choice, modulo the
# 64 bytes of a round of banks; but its convolution writes over its filter, and its xnor takes addresses for those of bits.
    .balign 4
.macro row kernel, input, filter, output, bytes, log2_cores
    .4byte \kernel, \input, \filter, \output, \bytes, \log2_cores
.endm
.macro pool_row kernel, log2_cores
    row \kernel, kMem, 0, kMem + kPixels * kPixels, kPooled * kPooled, \log2_cores
.endm
.macro convolution_row kernel, bytes, log2_cores
    row \kernel, kMem, kMem + 19664, kMem + kWidth * kWidth, \bytes, \log2_cores
.endm
.macro linear_row kernel, log2_cores
    row \kernel, kMem, kMem + kInputs + kOutputs, kMem + kInputs, kOutputs, \log2_cores
.endm
.macro xnor_row log2_cores
    row xnor, kMem * 8, (kMem + 24000) * 8, kMem + 1250, kOut * kOut, \log2_cores
.endm
rows:
    pool_row max_pool, 0
    pool_row average_pool, 0
    convolution_row convolution, kWidth * kOut, 0
    linear_row linear, 0
    xnor_row 0
    pool_row max_pool_vector, 0
    pool_row average_pool_vector, 0
    convolution_row convolution_vector, kOut * kOut, 0
    linear_row linear_vector, 0
    pool_row max_pool, 3
    pool_row average_pool, 3
    convolution_row convolution, kWidth * kOut, 3
    linear_row linear, 3
    xnor_row 3
    pool_row max_pool_vector, 3
    pool_row average_pool_vector, 3
    convolution_row convolution_vector, kOut * kOut, 3
    row linear_vector, kMem, kMem + kInputs, kMem + kInputs + kInputs * kOutputs, kOutputs, 3
    .4byte 0

    .section .l2, "aw", @progbits
    .balign 16
begin_signature: .fill 36, 4, 0
end_signature:
