# SPDX-License-Identifier: Apache-2.0
# Start and end of a bare-metal program at 0x80000000. The low seven bits of what main() gives back become the exit
# code: through tohost on mebots-soc and Spike, through the test device of the "virt" machine on QEMU (-DFOR_QEMU).
    .section .text.start, "ax"
    .globl _start
_start:
    .option push
    .option norelax
    la gp, __global_pointer$
    .option pop
    la sp, stack_top
    la t0, bss_begin
    la t1, bss_end
1:  bgeu t0, t1, 2f
    sw zero, 0(t0)
    addi t0, t0, 4
    j 1b
2:  call main
    andi a0, a0, 0x7f
#ifdef FOR_QEMU
    slli a0, a0, 16
    li t0, 0x3333
    or a0, a0, t0
    li t1, 0x100000
    sw a0, 0(t1)
#else
    slli a0, a0, 1
    ori a0, a0, 1
    la t0, tohost
    sw a0, 0(t0)
#endif
    .globl ended
ended: j ended

    .section .tohost, "aw", @progbits
    .balign 64
    .globl tohost
tohost: .dword 0
    .balign 64
    .globl fromhost
fromhost: .dword 0
