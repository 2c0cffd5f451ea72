// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"
#include "mebots/data/node.hpp"
#include "mebots/data/object.hpp"

#include <string>
#include <vector>

/// The keys `repeat` and `copies` of description.json: with these keys, one description describes both an FMU with one
/// object, such as a drone, and an FMU with several such objects. The copies of a variable are consecutive rows of the
/// table, so that FMI 3.0 has one array for them.
namespace mebots::modeldesc {

/// Reads `repeat`, {word: name of the parameter that holds the number of copies}. Returns the parameter's node.
data::Node read_repeat(const data::Node& node, Description& description);

/// Reads `copies` of a variable.
void read_copies(data::Object& object, Field& field, const Description& description);

/// Checks the parameter that contains the number of copies. Must be called after all variables were read.
void check_repeat(const data::Node& node, const Description& description);

/// Sets the names of the fields for `count` copies. Throws mebots::Error if the description repeats nothing, or if two
/// variables would have the same name.
void make_copies(Description& description, std::size_t count);

/// Returns the name that a variable would have in copy number `copy`, from 0. The description must have a `repeat`.
std::string name_in_copy(const Description& description, const std::string& name, std::size_t copy);

}  // namespace mebots::modeldesc
