# SPDX-License-Identifier: Apache-2.0
# Vectors of the fabric controller. All traps have the same entry, which reads mcause.
#include "runtime/vectors.inc"

    .section .text.trap_vectors, "ax"
    .balign 256
    .globl trap_vectors
trap_vectors:
    vectors trap_entry, _start
