// SPDX-License-Identifier: Apache-2.0
// A lamp with a button and a serial port. The button switches the lamp. The program answers each line with its length,
// and ends at the line "off".
#include <stdint.h>

#define REGISTER(type, address) (*(volatile type*)(address))
#define UART_DATA REGISTER(uint8_t, 0x10000000)
#define UART_STATUS REGISTER(uint8_t, 0x10000005)
#define BUTTON REGISTER(uint32_t, 0x10010000)
#define LAMP REGISTER(uint32_t, 0x10010004)
#define FINISHER REGISTER(uint32_t, 0x00100000)

enum { DATA_READY = 1, PASS = 0x5555 };

uint32_t presses;
uint32_t lines;
static char line[32];
static uint32_t length;

static void print(const char* text) {
  while (*text != '\0') UART_DATA = (uint8_t)*text++;
}

static void answer(void) {
  const int is_off = length == 3 && line[0] == 'o' && line[1] == 'f' && line[2] == 'f';
  ++lines;
  if (is_off) {
    print("good night\n");
    FINISHER = PASS;
  }
  const char digits[3] = {(char)('0' + length / 10), (char)('0' + length % 10), '\0'};
  print("length ");
  print(digits);
  print("\n");
  length = 0;
}

static void listen(void) {
  if ((UART_STATUS & DATA_READY) == 0) return;
  const char byte = (char)UART_DATA;
  if (byte == '\n') {
    answer();
  } else if (length < sizeof line) {
    line[length++] = byte;
  }
}

int main(void) {
  uint32_t was_pressed = 0;
  print("ready\n");
  for (;;) {
    listen();
    const uint32_t is_pressed = BUTTON;
    if (is_pressed != 0 && was_pressed == 0) {
      ++presses;
      LAMP = presses & 1;
    }
    was_pressed = is_pressed;
  }
}

__attribute__((naked, section(".text.start"))) void _start(void) {
  __asm__ volatile(
      ".option push\n .option norelax\n la gp, __global_pointer$\n .option pop\n"
      "li sp, 0x80010000\n j main");
}
