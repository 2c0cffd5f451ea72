// SPDX-License-Identifier: Apache-2.0
// A library inside an FMU.
#include "count.h"

int leftover_count(void) {
  static int calls = 0;
  return ++calls;
}
