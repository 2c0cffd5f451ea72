# SPDX-License-Identifier: Apache-2.0
# The trained weights, as data.
    .section .rodata.nn_weights, "a"
    .balign 16
    .globl nn_weights_file
nn_weights_file:
    .incbin "nn/navigator.weights"
    .byte 0
#if defined(__linux__)
    .section .note.GNU-stack, "", @progbits
#endif
