// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/statistics.hpp"

namespace mebots::master {

/// What stands between an ensemble and its slaves. All that is pointed to must outlive the ensemble.
struct SlaveOptions {
  Statistics* statistics = nullptr;  ///< where calls are counted; null = nowhere
};

}  // namespace mebots::master
