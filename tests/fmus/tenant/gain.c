// SPDX-License-Identifier: Apache-2.0
double tenant_gain(void);
__attribute__((visibility("default"))) double tenant_gain(void) {
  return TENANT_GAIN;
}
