// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// A variable of FMI 3.0: a field of the description, or one element if the field's group is not an array.
struct Fmi3Variable {
  const Field* field = nullptr;
  std::string name;
  std::uint32_t value_reference = 0;            // row of its first element in the table, as in FMI 2.0
  std::size_t rows = 1;                         // of the table
  std::size_t copies = 1;                       // of the repeated thing, the array's first dimension
  std::size_t words = 1;                        // elements per copy
  std::size_t first = 0;                        // first element of the field
  std::size_t elements = 1;                     // maximum number
  std::size_t start_elements = 1;               // number at the start
  bool is_array = false;                        // over copies, over the group's words, or over both
  std::optional<std::uint32_t> size_reference;  // of the structural parameter that holds the number of elements
  bool is_structural = false;                   // true for such a parameter
  std::string text;
};

/// Returns all variables in the order of the description, without the independent variable. Throws mebots::Error if an
/// array has the same name as another variable.
std::vector<Fmi3Variable> fmi3_variables(const Description& description);

/// The name of the independent variable. Its value reference is the number of rows in the variable table.
inline constexpr const char* kTimeName = "time";

/// Returns the number of rows per element of the field in the variable table. An OSMP binary has three rows.
std::size_t rows_per_element(const Field& field);

/// Returns the name of the variable's type in FMI 3.0: Float64, Int32, UInt64, Boolean, String, Binary or Enumeration.
const char* fmi3_type(const Fmi3Variable& variable);

}  // namespace mebots::modeldesc
