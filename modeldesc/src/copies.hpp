// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"
#include "mebots/data/node.hpp"
#include "mebots/data/object.hpp"

#include <string>
#include <vector>

/// The keys `repeat` and `copies` of description.json: with these keys, one description describes an FMU with one
/// object, such as a drone, and an FMU with several of them. The copies of a variable are consecutive rows of the
/// table, so that FMI 3.0 has one array for them.
namespace mebots::modeldesc {

/// Reads `repeat`, {word: name of the parameter that holds the number of copies}. Returns the parameter's node.
data::Node read_repeat(const data::Node& node, Description& description);

/// Reads `copies` of a variable.
void read_copies(data::Object& object, Field& field, const Description& description);

/// Checks the parameter that holds the number of copies, after all variables were read.
void check_repeat(const data::Node& node, const Description& description);

/// Gives the fields the names of `count` copies. Throws mebots::Error if the description repeats nothing, or if two
/// variables would have the same name.
void make_copies(Description& description, std::size_t count);

/// Returns the name that a variable has in a copy if it is copied. The description must have a `repeat`.
std::string name_in_copy(const Description& description, const std::string& name, std::size_t copy);

}  // namespace mebots::modeldesc
