// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmu/definition.hpp"
#include "mebots/fmu/model.hpp"

/// Definitions that the FMI shell (modeldesc/shell) shares with the code of FMUs.
namespace mebots::shell {

using fmu::Causality;
using fmu::Definition;
using fmu::EnumerationItem;
using fmu::Host;
using fmu::kNoField;
using fmu::Model;
using fmu::Severity;
using fmu::Type;
using fmu::Variability;
using fmu::Variable;

}  // namespace mebots::shell
