# SPDX-License-Identifier: Apache-2.0
# A program for board gap8. It sets up the camera by I2C and takes one picture after the other. For each picture, it sends the sums of the left and of the right half, each divided by 512, through SPI master 1.
    .equ kUdma, 0x1A102000
    .equ kEventUnit, 0x00204000
    .equ kEvents, 0x00200800
    .equ kSocEvents, 0x1A106000
    .equ kPicture, 0x1C040000
    .equ kRows, 244
    .equ kHalfRow, 162
    .equ kRun, 0x10

    .globl _start
_start: li s0, kUdma
    li s2, kEventUnit
    li s3, kSocEvents
    li a0, 0xfffbdfdf      # hears the ends of SPI master 1 (5), I2C master 1 (13) and camera (18)
    sw a0, 0x08(s3)
    li a0, 0x08000000      # the queue of SoC events ends a wait
    sw a0, 0x08(s2)
    la a0, window
    li a1, 13
    call tell_camera
    la a0, stream
    li a1, 10
    call tell_camera
    li a0, 0x80000500      # camera interface on, bytes in their order
    sw a0, 0x4a0(s0)

look: li a0, kPicture
    sw a0, 0x480(s0)
    li a0, 2 * kHalfRow * kRows
    sw a0, 0x484(s0)
    li a0, kRun
    sw a0, 0x488(s0)
    call wait
    li t0, kPicture
    li t1, kRows
    li t4, 0
    li t5, 0
row: li t2, kHalfRow
left: lbu t3, 0(t0)
    add t4, t4, t3
    addi t0, t0, 1
    addi t2, t2, -1
    bnez t2, left
    li t2, kHalfRow
right: lbu t3, 0(t0)
    add t5, t5, t3
    addi t0, t0, 1
    addi t2, t2, -1
    bnez t2, right
    addi t1, t1, -1
    bnez t1, row
    srli t4, t4, 9
    srli t5, t5, 9
    slli t5, t5, 16
    or t4, t4, t5
    la a0, sent
    sw t4, 12(a0)
    sw a0, 0x110(s0)
    li a0, 20
    sw a0, 0x114(s0)
    li a0, kRun
    sw a0, 0x118(s0)
    call wait
    j look

tell_camera: mv s4, ra
    sw a0, 0x310(s0)
    sw a1, 0x314(s0)
    li a0, kRun
    sw a0, 0x318(s0)
    call wait
    jr s4
wait: .insn i 0x03, 6, a4, 0x38(s2)
    li a3, kEvents
    lw a3, 0x700(a3)
    li a4, 0x08000000
    sw a4, 0x28(s2)
    ret

# Register 0x3010 = 1: 244 rows; 0x0100 = 1: streams.
window: .byte 0xE0, 0, 100, 0x00, 0x80, 0x48, 0xC0, 3, 0x80, 0x30, 0x10, 1, 0x20
stream: .byte 0x00, 0x80, 0x48, 0xC0, 3, 0x80, 0x01, 0x00, 1, 0x20
    .balign 4
# Divider, slave select, 32 bits of data that follow, and the end.
sent: .4byte 0x00000004, 0x10000000, 0x6000001f, 0, 0x90000000
