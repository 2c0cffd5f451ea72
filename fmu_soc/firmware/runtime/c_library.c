// SPDX-License-Identifier: Apache-2.0
// Implements the functions that picolibc calls: output of characters, and the end of the program. The library supports
// one thread, so that only the fabric controller may use it. The heap is the rest of L2. Standard input is empty.
#include <stdio.h>
#include <unistd.h>

#include "runtime/character.h"
#include "runtime/exit.h"

static int put(char c, FILE* stream) {
  (void)stream;
  put_char(c);
  return (unsigned char)c;
}

static int get(FILE* stream) {
  (void)stream;
  return EOF;
}

static FILE console = FDEV_SETUP_STREAM(put, get, NULL, _FDEV_SETUP_RW);

FILE* const stdin = &console;
FILE* const stdout = &console;
FILE* const stderr = &console;

// Called by exit() and abort().
void _exit(int code) {
  firmware_exit(code);
  __builtin_unreachable();
}
