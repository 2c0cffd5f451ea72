// SPDX-License-Identifier: Apache-2.0
// Returns 23 if the program is compiled without optimisation. The program is linked to another address than other
// tests.
int main(void) {
#ifdef __OPTIMIZE__
  return 1;
#else
  return 23;
#endif
}
