// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <string_view>

namespace mebots::modeldesc {

/// Returns the variable of this name in a description with arrays. For an element of an array, such as "m[2,3]",
/// returns the array if it has this element, or may have it with other values of structural parameters. Returns null
/// for any other name.
const Variable* declared_variable(const ModelDescription& description, std::string_view name);

}  // namespace mebots::modeldesc
