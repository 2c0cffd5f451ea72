// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <string_view>

namespace mebots::check {

/// Compares the text of a modelDescription.xml with the grammar of FMI 2.0: elements, their order and number,
/// attributes, the form of their values, and the encoding.
void check_schema(std::string_view text, Findings findings);

}  // namespace mebots::check
