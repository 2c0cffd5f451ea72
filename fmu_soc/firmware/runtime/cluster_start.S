# SPDX-License-Identifier: Apache-2.0
# Starts the cluster's cores after the cluster was switched on. Each core takes its stack at the end of L1. In an
# endless loop, it waits for a job, runs the job and reports the end.
#include "board.h"
#include "runtime/cluster_stack.inc"

    .section .text.cluster_start, "ax"
    .globl cluster_start
    .type cluster_start, @function
cluster_start:
    global_pointer
    csrr    t0, mhartid            # 0 to 7
    own_stack

    li      s0, EVENT_UNIT_BASE
3:  .insn i 0x03, 6, t0, EVENT_UNIT_DISPATCH_WAIT_OFFSET(s0)   # p.elw: sleeps until a fork names this core
    lw      a0, EVENT_UNIT_DISPATCH_ARGUMENT_OFFSET(s0)
    jalr    t0
    sw      zero, EVENT_UNIT_JOB_DONE_OFFSET(s0)
    j       3b
    .size cluster_start, . - cluster_start
