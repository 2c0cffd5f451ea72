# SPDX-License-Identifier: Apache-2.0
# Runs main() on core 0 of the cluster, with data and stack in L1, and leaves its result and the cycles of the cluster's
# timer in the file "result".
    .option norvc
    .option norelax
    .equ kStarted, 1               # cores of the cluster
    .equ kEventUnit, 0x00204000
    .equ kTimer, 0x00200400
    .include "cluster_boot.inc"

core: la gp, __global_pointer$
    la sp, stack_top
    la t0, bss_begin
    la t1, bss_end
1:  bgeu t0, t1, 2f
    sw zero, 0(t0)
    addi t0, t0, 4
    j 1b
2:  li s0, kTimer
    li t1, 3                       # on, from 0
    sw t1, 0(s0)
    lw s1, 8(s0)
    call main
    lw t1, 8(s0)
    sub t1, t1, s1
    la t0, begin_signature
    sw a0, 0(t0)
    sw t1, 4(t0)
    la t0, done
    li t1, 1
    sw t1, 0(t0)
    li s0, kEventUnit
3:  .insn i 0x03, 6, t0, 0x3c(s0)  # p.elw, for ever: no event comes
    j 3b

    .section .l2, "aw", @progbits
    .balign 4
begin_signature: .word 0, 0
end_signature:
