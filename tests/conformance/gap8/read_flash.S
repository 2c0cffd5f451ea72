# SPDX-License-Identifier: Apache-2.0
# Copies the second sector of the HyperFlash into L2, whatever ran before: for scripts/gap8_jtag.py, which looks there.
    .equ kUdma, 0x1A102000
    .equ kSectorBytes, 0x40000
    .equ kBuffer, 0x1C020000

    .globl _start
_start: csrw mstatus, zero     # interrupts of who was here before are not ours
    li s0, kUdma
    lw a1, 0x1b8(s0)           # where the flash begins on the HyperBus
    slli a1, a1, 24
    li a2, kSectorBytes
    add a1, a1, a2
    sw a1, 0x1a0(s0)
    li a0, kBuffer
    sw a0, 0x180(s0)
    sw a2, 0x184(s0)
    li a0, 0x10
    sw a0, 0x188(s0)
1:  lw a0, 0x188(s0)
    andi a0, a0, 0x10
    bnez a0, 1b
    la a0, read_flash_done
    sw s0, 0(a0)
2:  j 2b
    .balign 4
    .globl read_flash_done
read_flash_done: .4byte 0
