// SPDX-License-Identifier: Apache-2.0
// Calls generated code (branchy.py) TURNS times. main() returns a checksum of the results.
unsigned turn(unsigned x);

int main(void) {
  unsigned x = 1;
  for (int i = 0; i < TURNS; ++i) x = turn(x);
  return (int)((x ^ x >> 8 ^ x >> 16) & 0x7f);
}
