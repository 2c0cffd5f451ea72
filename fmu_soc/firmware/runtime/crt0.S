# SPDX-License-Identifier: Apache-2.0
# First instructions after reset: set stack and trap vector, clear variables, call main(), and exit.
#include "runtime/start.h"

    .section .text.start, "ax"
    .globl _start
    .type _start, @function
_start:
    .option push
    .option norelax
    la      gp, __global_pointer$
    .option pop
    la      sp, __stack_top
#ifdef WITH_C_LIBRARY
    la      tp, __tls_base
#endif
    la      t0, TRAP_VECTORS
    csrw    mtvec, t0
    NO_INTERRUPT

    la      t0, __bss_start
    la      t1, __bss_end
1:  bgeu    t0, t1, 2f
    sw      zero, 0(t0)
    addi    t0, t0, 4
    j       1b

2:  START_CHIP
#ifdef __riscv_flen
    li      t0, 0x2000             # mstatus.FS: a core with floats starts with its unit off
    csrs    mstatus, t0
#endif
#ifdef WITH_CONSTRUCTORS
    la      s0, __init_array_start
    la      s1, __init_array_end
3:  bgeu    s0, s1, 4f
    lw      t0, 0(s0)
    addi    s0, s0, 4
    jalr    t0
    j       3b
4:
#endif
    li      a0, 0
    li      a1, 0
    call    main
    call    firmware_exit          # does not return
5:  wfi
    j       5b
    .size _start, . - _start
