// SPDX-License-Identifier: Apache-2.0
#include "isolation/fmu_host.hpp"

int main(int argument_count, char** arguments) {
  return mebots::master::run_fmu_host(argument_count, arguments);
}
