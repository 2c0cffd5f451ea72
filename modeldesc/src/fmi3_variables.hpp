// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// A variable of FMI 3.0. It represents a whole field of the description, or one element of a field whose group is not
/// an array.
struct Fmi3Variable {
  const Field* field = nullptr;
  std::string name;
  std::uint32_t value_reference = 0;            // row of the first element in the variable table
  std::size_t rows = 1;                         // number of rows in the variable table
  std::size_t copies = 1;                       // number of copies; the array's first dimension
  std::size_t words = 1;                        // number of elements per copy
  std::size_t first = 0;                        // index of the first element in the field
  std::size_t elements = 1;                     // maximum number of elements
  std::size_t start_elements = 1;               // number of elements at the start
  bool is_array = false;                        // an array over copies, over the group's words, or over both
  std::optional<std::uint32_t> size_reference;  // of the structural parameter that sets the size
  bool is_structural = false;                   // true if this variable is a structural parameter
  std::string text;
};

/// Returns all variables except the independent variable, in the order of the description. Throws mebots::Error if an
/// array has the same name as another variable.
std::vector<Fmi3Variable> fmi3_variables(const Description& description);

/// The name of the independent variable. Its value reference is the number of rows in the variable table.
inline constexpr const char* kTimeName = "time";

/// Returns the number of rows of one element in the variable table: three for an OSMP binary, otherwise one.
std::size_t rows_per_element(const Field& field);

/// Returns the FMI 3.0 name of the variable's type: Float64, Int32, UInt64, Boolean, String, Binary or Enumeration.
const char* fmi3_type(const Fmi3Variable& variable);

}  // namespace mebots::modeldesc
