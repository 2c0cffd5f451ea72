// SPDX-License-Identifier: Apache-2.0
// Defines the functions of cluster.h that start copies of the DMA. A chip's source file must define start() before it
// includes this file.

static uint32_t word(const volatile void* address) {
  return (uint32_t)(uintptr_t)address;
}

uint32_t dma_copy_in(void* l1, const void* l2, uint32_t bytes) {
  return start(DMA_IN, word(l1), word(l2), bytes, 0, 0);
}

uint32_t dma_copy_out(void* l2, const void* l1, uint32_t bytes) {
  return start(DMA_OUT, word(l1), word(l2), bytes, 0, 0);
}

uint32_t dma_copy_in_2d(void* l1, const void* l2, uint32_t bytes, uint32_t row, uint32_t stride) {
  return start(DMA_IN, word(l1), word(l2), bytes, row, stride);
}

uint32_t dma_copy_out_2d(void* l2, const void* l1, uint32_t bytes, uint32_t row, uint32_t stride) {
  return start(DMA_OUT, word(l1), word(l2), bytes, row, stride);
}
