// SPDX-License-Identifier: Apache-2.0
// The network on the cluster with the kernels scheduled by hand in place of the compiler's.
#include "nn/hand.h"

#define nn_fast_shrink nn_hand_shrink
#define nn_fast_first nn_hand_first
#include "nn/cluster_net.c"
