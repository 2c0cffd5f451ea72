// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Includes all headers that a program needs to run systems of FMUs.
#include "mebots/mission.hpp"
#include "mebots/version.hpp"
