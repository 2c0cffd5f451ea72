// SPDX-License-Identifier: Apache-2.0
// Returns 23 if the program is compiled without optimisation. Its own linker script uses only the upper half of L2.
int main(void) {
#ifdef __OPTIMIZE__
  return 1;
#else
  return 23;
#endif
}
