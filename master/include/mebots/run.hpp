// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Includes all headers for running systems of FMUs.
#include "mebots/mission.hpp"
#include "mebots/version.hpp"
