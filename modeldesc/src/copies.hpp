// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"
#include "mebots/data/node.hpp"
#include "mebots/data/object.hpp"

#include <string>
#include <vector>

/// Reads the keys `repeat` and `copies` of description.json. With these keys, one description suffices for FMUs with
/// one object, such as a drone, and for FMUs with several objects. The copies of a variable are consecutive rows of the
/// variable table, so that they can form one array in FMI 3.0.
namespace mebots::modeldesc {

/// Reads the key `repeat`, an object {word: name of the parameter that contains the number of copies}. Returns the node
/// of the parameter's name.
data::Node read_repeat(const data::Node& node, Description& description);

void read_copies(data::Object& object, Field& field, const Description& description);

/// Adds a mistake if the parameter that contains the number of copies does not exist, or if it has an unsuitable type,
/// causality, variability or minimum. `node` is the result of read_repeat(). Call this function after all variables
/// were read.
void check_repeat(const data::Node& node, const Description& description);

/// Sets the FMI names of all fields for `count` copies. Throws mebots::Error if two variables would have the same name,
/// or if `count` is not 1 but the description has no `repeat`.
void make_copies(Description& description, std::size_t count);

/// Returns the name of a variable in a copy. `copy` starts at 0. The description must have a `repeat`.
std::string name_in_copy(const Description& description, const std::string& name, std::size_t copy);

}  // namespace mebots::modeldesc
