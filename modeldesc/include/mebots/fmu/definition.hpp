// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi/variable_kinds.hpp"
#include "mebots/fmu/model.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

/// Defines the types of an FMU's constant tables. The build generates the tables. The FMI shell (modeldesc/shell) reads
/// them.
namespace mebots::fmu {

using fmi::Causality;
using fmi::Type;
using fmi::Variability;

struct EnumerationItem {
  std::int32_t value;
  std::string_view name;
};

/// The offset of a variable without a field. The value of such a variable is computed when an importer reads it.
inline constexpr std::size_t kNoField = static_cast<std::size_t>(-1);

/// Marks a variable whose number of elements is fixed.
inline constexpr std::size_t kFixedSize = static_cast<std::size_t>(-1);

/// A scalar variable of FMI 2.0, and the offset of its value in the instance's variables. In FMI 3.0, the elements of
/// an array, or the parts of a Binary, are consecutive rows that form one variable.
struct Variable {
  std::string_view name;
  Type type;
  Causality causality;
  Variability variability;
  std::size_t offset;  // offset in bytes in the instance's variables; kNoField for an on-demand String
  double min;
  double max;
  std::string_view unit;
  std::span<const EnumerationItem> items;
  bool is_pointer;                    // part of an OSMP triple: not saved in states
  std::size_t elements = 1;           // elements of the FMI 3.0 variable that begins here; 0 = none begins here
  std::size_t size_row = kFixedSize;  // row of the structural parameter that sets the number of elements
  bool is_structural = false;         // true if this variable is a structural parameter
  std::size_t per_size = 1;           // elements per unit of the structural parameter's value
};

struct Definition {
  std::string_view model_identifier;
  std::string_view guid;                 // identifies the FMU in FMI 2.0
  std::string_view instantiation_token;  // identifies the FMU in FMI 3.0; empty if the FMU is not built for FMI 3.0
  std::span<const Variable> variables;   // the index is the value reference; in FMI 3.0, the index of the first row
  std::span<const std::string_view> log_categories;
  std::shared_ptr<void> (*make_variables)();
  std::unique_ptr<Model> (*make_model)(void* variables, Host& host, std::int64_t start_ns);
};

/// The FMU's tables. Each FMU defines this constant once, in the generated variable_table.cpp.
extern const Definition kDefinition;

}  // namespace mebots::fmu
