# SPDX-License-Identifier: Apache-2.0
# Includes the trained weights as data.
    .section .rodata.nn_weights, "a"
    .balign 16
    .globl nn_weights_file
nn_weights_file:
#ifdef NN_SIGHT
    .incbin "nn/sight.weights"
#else
    .incbin "nn/navigator.weights"
#endif
    .byte 0
#if defined(__linux__)
    .section .note.GNU-stack, "", @progbits
#endif
