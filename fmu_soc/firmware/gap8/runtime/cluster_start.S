# SPDX-License-Identifier: Apache-2.0
# Starts the cluster's cores. Each core takes its stack at the end of L1. In an endless loop, it waits for a job, runs
# the job and reports the end. The cores take no interrupts. An exception ends the program.
#include "runtime/cluster_stack.inc"
#include "runtime/registers.h"
#include "runtime/vectors.inc"

    .equ kException, 255           # EXIT_EXCEPTION

    .section .text.cluster_vectors, "ax"
    .balign 256
    .globl cluster_vectors
cluster_vectors:
    vectors cluster_trap, cluster_start
cluster_trap:
    li      t0, SOC_CONTROL_BASE
    li      t1, 0x80000000 | kException
    sw      t1, SOC_CONTROL_CORESTATUS_OFFSET(t0)
1:  j       1b

    .section .text.cluster_start, "ax"
    .globl cluster_start
    .type cluster_start, @function
cluster_start:
    global_pointer
    csrr    s1, mhartid            # 0 to 7
    mv      t0, s1
    own_stack

    li      s0, EU_BASE
    li      s2, 1 << CLUSTER_EVENT_JOB
    li      s3, 1 << CLUSTER_EVENT_BARRIER
    la      s4, cluster_job
3:  sw      s2, EU_MASK_OFFSET(s0)
    .insn i 0x03, 6, zero, EU_WAIT_CLEAR_OFFSET(s0)   # p.elw: sleeps until a fork names this core
    sw      s3, EU_MASK_OFFSET(s0)
    lw      t0, 0(s4)
    lw      a0, 4(s4)
    jalr    t0
    beqz    s1, 4f
    lw      zero, EU_BARRIER_OFFSET + BARRIER_BYTES + BARRIER_ARRIVE_OFFSET(s0)   # done; core 0 waits for all
    j       3b
4:  .insn i 0x03, 6, zero, EU_BARRIER_OFFSET + BARRIER_BYTES + BARRIER_ARRIVE_WAIT_OFFSET(s0)
    li      t0, EU_OF_FABRIC_CONTROLLER_BASE + EU_SOFTWARE_EVENT_OFFSET
    sw      zero, 4 * FABRIC_EVENT_JOB_DONE(t0)
    j       3b
    .size cluster_start, . - cluster_start
