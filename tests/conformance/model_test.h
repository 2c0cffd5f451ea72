// SPDX-License-Identifier: Apache-2.0
// Definitions that riscv-arch-test requires of a machine: how a program ends (Spike's tohost), and where its result
// words are.
#pragma once

#define RVMODEL_BOOT
#define RVMODEL_IO_INIT
#define RVMODEL_IO_WRITE_STR(register, text)
#define RVMODEL_IO_CHECK()
#define RVMODEL_IO_ASSERT_GPR_EQ(scratch, register, value)
#define RVMODEL_IO_ASSERT_SFPR_EQ(scratch, register, value)
#define RVMODEL_IO_ASSERT_DFPR_EQ(scratch, register, value)
#define RVMODEL_SET_MSW_INT
#define RVMODEL_CLEAR_MSW_INT
#define RVMODEL_CLEAR_MTIMER_INT
#define RVMODEL_CLEAR_MEXT_INT

// clang-format off
#define RVMODEL_HALT      \
    li t0, 1;             \
    la t1, tohost;        \
    sw t0, 0(t1);         \
    sw zero, 4(t1);       \
  ended:                  \
    j ended;

#define RVMODEL_DATA_BEGIN                         \
    .pushsection .tohost, "aw", @progbits;         \
    .balign 64; .global tohost; tohost: .dword 0;  \
    .balign 64; .global fromhost; fromhost: .dword 0; \
    .popsection;                                   \
    .balign 16; .global begin_signature; begin_signature:

#define RVMODEL_DATA_END \
    .balign 4; .global end_signature; end_signature:
// clang-format on
