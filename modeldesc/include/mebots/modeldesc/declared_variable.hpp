// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <string_view>

namespace mebots::modeldesc {

/// Returns the variable with this name in a description with arrays. For the name of an element, such as "m[2,3]",
/// returns the array if it has this element, or can have it with other values of structural parameters. Otherwise
/// returns null.
const Variable* declared_variable(const ModelDescription& description, std::string_view name);

}  // namespace mebots::modeldesc
