// SPDX-License-Identifier: Apache-2.0
// Executes an event TURNS times. EVENT selects the event: 1 is a load from a device register, 2 a read of a counter, 3
// a trap. Other values execute no event. Runs on QEMU's machine "virt" and on board virt. The register is the interrupt
// priority of the PLIC's first source.
#include <stdint.h>

static uint32_t sum;

static void __attribute__((naked, aligned(256))) handler(void) {
  __asm__ volatile("csrr t0, mepc\n addi t0, t0, 4\n csrw mepc, t0\n mret");
}

static inline uint32_t event(void) {
  uint32_t value = 0;
#if EVENT == 1
  value = *(volatile uint32_t*)0x0c000004;
#elif EVENT == 2
  __asm__ volatile("csrr %0, mcycle" : "=r"(value));
  value = 0;  // omits the cycles from the checksum, because they differ between simulators
#elif EVENT == 3
  __asm__ volatile(".option push\n.option norvc\necall\n.option pop" ::: "t0");
#endif
  return value;
}

int main(void) {
  __asm__ volatile("csrw mtvec, %0" ::"r"(handler));
  for (uint32_t turn = 0; turn < TURNS; ++turn) {
    sum += event() + turn;
  }
  return (int)((sum ^ sum >> 7 ^ sum >> 14) & 0x7f);
}
