// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "description.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// A variable of FMI 3.0: a field of the description, or one element of it if its group is no array.
struct Fmi3Variable {
  const Field* field = nullptr;
  std::string name;
  std::uint32_t value_reference = 0;  // row of its first element in the table, as FMI 2.0 counts
  std::size_t rows = 1;               // of the table
  std::size_t first = 0;              // element of the field
  std::size_t elements = 1;           // as many as there can be
  std::size_t start_elements = 1;     // as many as there are at the start
  bool is_array = false;
  std::optional<std::uint32_t> size_reference;  // of the structural parameter with the number of elements
  bool is_structural = false;                   // such a parameter
  std::string text;
};

/// All of them, in the order of the description, without the independent variable. Throws mebots::Error if an array
/// would have the name of another variable.
std::vector<Fmi3Variable> fmi3_variables(const Description& description);

/// Name of the independent variable. Its value reference is the number of rows of the table.
inline constexpr const char* kTimeName = "time";

/// Rows of the table that one element of the field takes: an OSMP triple has three.
std::size_t rows_per_element(const Field& field);

/// The word of its type: Float64, Int32, UInt64, Boolean, String, Binary or Enumeration.
const char* fmi3_type(const Fmi3Variable& variable);

}  // namespace mebots::modeldesc
