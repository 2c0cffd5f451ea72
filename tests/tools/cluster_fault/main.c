// SPDX-License-Identifier: Apache-2.0
// A core of the cluster executes an illegal instruction.
#include "runtime/cluster.h"

static void fail(unsigned core) {
  if (core == 3) {
    __asm__ volatile(".word 0");
  }
}

static void work(void* argument) {
  (void)argument;
  fail(cluster_core_id());
}

int main(void) {
  cluster_on();
  cluster_fork(work, 8, 0);
  cluster_wait();
  return 0;
}
