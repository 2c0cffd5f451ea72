# SPDX-License-Identifier: Apache-2.0
# Runs the micro programs of tests/soc/rtl on core 0 of the cluster, and writes their recorded counts to the file "result".
    .option norvc
    .option norelax
    .equ kStarted, 1               # cores of the cluster
    .equ kEventUnit, 0x00204000
    .include "cluster_boot.inc"

core: la s0, results
    sw zero, 0(s0)
    addi s0, s0, 4
    call micro
    la t0, done
    li t1, 1
    sw t1, 0(t0)
    li s0, kEventUnit
1:  .insn i 0x03, 6, t0, 0x3c(s0)  # p.elw, for ever: no event comes
    j 1b

    .globl results
    .section .l2, "aw", @progbits
    .balign 4
begin_signature:
results: .space 64 * 160
end_signature:
