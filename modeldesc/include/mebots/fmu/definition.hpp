// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi2/variable_kinds.hpp"
#include "mebots/fmu/model.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

/// What the shell knows of the FMU that it serves: constant tables that the build generates.
namespace mebots::fmu {

using fmi2::Causality;
using fmi2::Type;
using fmi2::Variability;

struct EnumerationItem {
  std::int32_t value;
  std::string_view name;
};

/// Offset of a variable that is made when read.
inline constexpr std::size_t kNoField = static_cast<std::size_t>(-1);

/// One scalar FMI variable and where its value lies in the instance's variables.
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
  bool is_pointer;  // part of an OSMP triple: not kept in a state
};

struct Definition {
  std::string_view model_identifier;
  std::string_view guid;
  std::span<const Variable> variables;  // the value reference is the index
  std::span<const std::string_view> log_categories;
  std::shared_ptr<void> (*make_variables)();
  std::unique_ptr<Model> (*make_model)(void* variables, Host& host, std::int64_t start_ns);
};

/// Defined once per FMU, in the generated variable_table.cpp.
extern const Definition kDefinition;

}  // namespace mebots::fmu
