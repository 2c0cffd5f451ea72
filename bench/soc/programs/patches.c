// SPDX-License-Identifier: Apache-2.0
// Changes its own code. TURNS times, overwrites the immediate of an instruction, and calls the function with this
// instruction. main() returns the sum of the results.
#include <stdint.h>

// The function is: addi a0, zero, 0; ret
static uint32_t function[] = {0x00000513, 0x00008067};

int main(void) {
  volatile uint32_t* const code = function;
  unsigned sum = 0;
  for (uint32_t turn = 0; turn < TURNS; ++turn) {
    code[0] = (turn & 0x7ff) << 20 | 0x513;
    __asm__ volatile("fence.i" ::: "memory");
    sum += ((unsigned (*)(void))(uintptr_t)function)();
  }
  return (int)(sum & 0x7f);
}
