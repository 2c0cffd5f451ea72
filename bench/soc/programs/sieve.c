// SPDX-License-Identifier: Apache-2.0
// Counts the primes below 100 000 with a sieve.
#include <stdint.h>

#define LIMIT 100000

static uint8_t crossed[LIMIT];

static __attribute__((noinline)) int count_primes(int limit) {
  int count = 0;
  for (int i = 0; i < limit; ++i) crossed[i] = 0;
  for (int i = 2; i < limit; ++i) {
    if (crossed[i]) continue;
    ++count;
    for (int j = 2 * i; j < limit; j += i) crossed[j] = 1;
  }
  return count;
}

int main(void) {
  int sum = 0;
  for (int turn = 0; turn < TURNS; ++turn) sum += count_primes(LIMIT - turn % 1000);
  return sum;
}
