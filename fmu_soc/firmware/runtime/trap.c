// SPDX-License-Identifier: Apache-2.0
// Dispatches interrupts of the fabric controller. An exception ends the program.
#include <stddef.h>

#include "runtime/console.h"
#include "runtime/core.h"
#include "runtime/exit.h"
#include "runtime/interrupt.h"

#define INTERRUPT_COUNT 32

// CV32E40P with floating-point instructions clears the low eight bits of mtvec.
#ifdef __riscv_flen
#define ENTRY_ALIGNMENT 256
#else
#define ENTRY_ALIGNMENT 4
#endif

static interrupt_handler_t handlers[INTERRUPT_COUNT];

void interrupt_attach(unsigned number, interrupt_handler_t handler) {
  handlers[number] = handler;
  core_enable_interrupt(number);
}

static void end_on_exception(uint32_t cause) {
  uint32_t pc;
  uint32_t value;
  __asm__ volatile("csrr %0, mepc" : "=r"(pc));
  __asm__ volatile("csrr %0, mtval" : "=r"(value));
  print("exception: mcause %u, mepc 0x%x, mtval 0x%x\n", cause, pc, value);
  firmware_exit(EXIT_EXCEPTION);
}

void __attribute__((interrupt("machine"), aligned(ENTRY_ALIGNMENT), used)) trap_entry(void) {
  uint32_t cause;
  __asm__ volatile("csrr %0, mcause" : "=r"(cause));
  if ((cause >> 31) == 0) {
    end_on_exception(cause);
  }
  const uint32_t number = cause & 0x7FFFFFFF;
  if (number >= INTERRUPT_COUNT || handlers[number] == NULL) {
    print("interrupt %u has no handler\n", number);
    firmware_exit(EXIT_EXCEPTION);
  }
  handlers[number]();
}
