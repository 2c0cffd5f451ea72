// SPDX-License-Identifier: Apache-2.0
// Measures twenty times and reports each value.
#include "my_sensor.h"
#include "runtime/console.h"

#define MEASUREMENTS 20

int main(void) {
  my_sensor_init();
  for (int count = 0; count < MEASUREMENTS; ++count) {
    const int32_t value = my_sensor_measure();
    my_sensor_report(value);
    print("my_sensor %m\n", value);
  }
  return 0;
}
