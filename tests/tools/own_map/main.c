// SPDX-License-Identifier: Apache-2.0
// Built without optimisation, at a separate address.
int main(void) {
#ifdef __OPTIMIZE__
  return 1;
#else
  return 23;
#endif
}
