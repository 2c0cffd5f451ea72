# SPDX-License-Identifier: Apache-2.0
# Runs the random segments of random_segments.cpp (segments.inc) on the fabric controller of the open PULP chip, and
# leaves its log and its data in the file "result", by semihosting. random_xpulp.py reads it.
#
# The log has two kinds of records: of a segment, its number and x1 to x31, and of a watched instruction kWatched, its
# word, what rs1, rs2 and rd had, and the result.

    .option norvc
    .option norelax
    .equ kLog, 0x1C030000
    .equ kData, 0x1C040000
    .equ kDataBytes, 0x40000
    .equ kWatched, 0x80000000

# Segments leave alone x17, which points behind the last record, and x18.
.macro segment first, registers:vararg
    la x18, 8f
    .irp n, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31
    lw x\n, 4 * \n(x18)
    .endr
    .pushsection .data
8:  .word \first, \registers
    .popsection
.endm
.macro end_segment number
    li x18, \number
    sw x18, 0(x17)
    .irp n, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31
    sw x\n, 4 * \n(x17)
    .endr
    sw x0, 4 * 17(x17)
    sw x0, 4 * 18(x17)
    addi x17, x17, 128
.endm
# Operands of a watched instruction.
.macro log_watched word, rd, rs1, rs2
    li x18, kWatched
    sw x18, 0(x17)
    li x18, \word
    sw x18, 4(x17)
    sw x\rs1, 8(x17)
    sw x\rs2, 12(x17)
    sw x\rd, 16(x17)
.endm
# One instruction, whose rd has `after` behind it.
.macro watch word, rd, rs1, rs2, after
    log_watched \word, \rd, \rs1, \rs2
    .word \word
    sw x\rd, 20(x17)
    li x\rd, \after
    addi x17, x17, 24
.endm
# Likewise a store with post-increment, whose pointer is x\rd: what lies at the pointer's old place is the result.
.macro watch_store word, rd, rs1, rs2, after
    log_watched \word, \rd, \rs1, \rs2
    mv x18, x\rs1
    sw x0, 0(x18)
    .word \word
    lw x\rd, 0(x18)
    sw x\rd, 20(x17)
    sw x0, 0(x18)
    li x\rd, \after
    addi x17, x17, 24
.endm
    .include "call_host.inc"
    .include "noise.inc"

    .text
# Exceptions come here: an instruction that a core does not know is the log's last word.
vectors:
    csrr x18, mepc
    sw x18, 0(x17)
    addi x17, x17, 4
    j finish
    .balign 256
    .globl _start
_start:
    la t0, vectors
    csrw mtvec, t0
    fill_noise kData, kDataBytes
    li x17, kLog
    .include "segments.inc"

finish:
    call_host 1, open
    la t0, log
    sw a0, 0(t0)
    la t1, data
    sw a0, 0(t1)
    la t1, close
    sw a0, 0(t1)
    li t1, kLog
    sub t1, x17, t1
    sw t1, 8(t0)
    call_host 5, log
    call_host 5, data
    call_host 2, close
    li a1, 0x20026
    call_host 0x18
2:  j 2b

    .data
    .balign 4
open:   .word name, 5, 6               # to write bytes
log:    .word 0, kLog, 0
data:   .word 0, kData, kDataBytes
close:  .word 0
name:   .asciz "result"
