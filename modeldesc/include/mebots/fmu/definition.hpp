// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi/variable_kinds.hpp"
#include "mebots/fmu/model.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

/// What the shell knows of the FMU that it serves: constant tables that the build generates.
namespace mebots::fmu {

using fmi::Causality;
using fmi::Type;
using fmi::Variability;

struct EnumerationItem {
  std::int32_t value;
  std::string_view name;
};

/// Offset of a variable that is made when read.
inline constexpr std::size_t kNoField = static_cast<std::size_t>(-1);

/// Marks a variable whose number of elements is fixed.
inline constexpr std::size_t kFixedSize = static_cast<std::size_t>(-1);

/// One scalar variable of FMI 2.0 and where its value lies in the instance's variables. FMI 3.0 sees rows that follow
/// each other as one variable where they are the elements of an array, or the parts of a Binary.
struct Variable {
  std::string_view name;
  Type type;
  Causality causality;
  Variability variability;
  std::size_t offset;  // bytes into the variables; kNoField for an on-demand String
  double min;
  double max;
  std::string_view unit;
  std::span<const EnumerationItem> items;
  bool is_pointer;                    // part of an OSMP triple: not kept in a state
  std::size_t elements = 1;           // of the variable of FMI 3.0 that begins here; 0 = none begins here
  std::size_t size_row = kFixedSize;  // row of the structural parameter with the number of elements, if there is one
  bool is_structural = false;         // such a parameter
};

struct Definition {
  std::string_view model_identifier;
  std::string_view guid;                 // of FMI 2.0
  std::string_view instantiation_token;  // of FMI 3.0; empty when it is not built for that
  std::span<const Variable> variables;   // the value reference is the index; in FMI 3.0, that of the first row
  std::span<const std::string_view> log_categories;
  std::shared_ptr<void> (*make_variables)();
  std::unique_ptr<Model> (*make_model)(void* variables, Host& host, std::int64_t start_ns);
};

/// Defined once per FMU, in the generated variable_table.cpp.
extern const Definition kDefinition;

}  // namespace mebots::fmu
