// SPDX-License-Identifier: Apache-2.0
#include "runtime/console.h"

#include <stdarg.h>
#include <stdint.h>

#include "runtime/character.h"

static void put_text(const char* text) {
  while (*text != '\0') {
    put_char(*text++);
  }
}

static void put_number(uint32_t value, uint32_t base, int least_digits) {
  char digits[12];
  int count = 0;
  do {
    digits[count++] = "0123456789abcdef"[value % base];
    value /= base;
  } while (value != 0 || count < least_digits);
  while (count > 0) {
    put_char(digits[--count]);
  }
}

static uint32_t put_sign(int32_t value) {
  if (value < 0) {
    put_char('-');
    return 0U - (uint32_t)value;
  }
  return (uint32_t)value;
}

static void put_thousandths(uint32_t thousandths) {
  put_number(thousandths / 1000, 10, 1);
  put_char('.');
  put_number(thousandths % 1000, 10, 3);
}

void print(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  for (const char* at = format; *at != '\0'; ++at) {
    if (*at != '%') {
      put_char(*at);
      continue;
    }
    ++at;
    switch (*at) {
      case 'd':
        put_number(put_sign(va_arg(arguments, int32_t)), 10, 1);
        break;
      case 'u':
        put_number(va_arg(arguments, uint32_t), 10, 1);
        break;
      case 'x':
        put_number(va_arg(arguments, uint32_t), 16, 1);
        break;
      case 'm':
        put_thousandths(put_sign(va_arg(arguments, int32_t)));
        break;
      case 'M':
        put_thousandths((put_sign(va_arg(arguments, int32_t)) + 500) / 1000);
        break;
      case 's':
        put_text(va_arg(arguments, const char*));
        break;
      case 'c':
        put_char((char)va_arg(arguments, int));
        break;
      case '\0':
        va_end(arguments);
        return;
      default:
        put_char(*at);
        break;
    }
  }
  va_end(arguments);
}
