// SPDX-License-Identifier: Apache-2.0
// Reads and sets values in FMI 3.0. Converts references of whole arrays to rows of the variable table.
#include "fmi3_calls.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

namespace mebots::shell {
namespace {

constexpr std::uint8_t kReadable = legal::kAlive;
constexpr std::uint8_t kSettable =
    legal::kInstantiated | legal::kConfiguration | legal::kInitialization | legal::kStepComplete;

std::string_view type_word(const Variable& variable) {
  if (variable.is_pointer) return "Binary";
  switch (variable.type) {
    case Type::real:
      return "Float64";
    case Type::integer:
      return variable.is_structural ? "UInt64" : "Int32";
    case Type::boolean:
      return "Boolean";
    case Type::string:
      return "String";
    case Type::enumeration:
      return "Int64";  // enumerations are read and set by the functions for Int64
    default:
      return {};
  }
}

using Rows = std::span<const fmi2ValueReference>;

void read(Instance& instance, Rows rows, std::span<fmi3Float64> values) {
  const auto time_row = static_cast<fmi2ValueReference>(instance.definition().variables.size());
  if (std::ranges::find(rows, time_row) == rows.end()) return instance.get(rows, values);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] == time_row)
      values[i] = instance.time_s();
    else
      instance.get(rows.subspan(i, 1), values.subspan(i, 1));
  }
}

void read(Instance& instance, Rows rows, std::span<fmi3Int32> values) {
  instance.get(rows, values);
}

void read(Instance& instance, Rows rows, std::span<fmi3String> values) {
  instance.get(rows, values);
}

void read(Instance& instance, Rows rows, std::span<fmi3Boolean> values) {
  std::vector<fmi2Boolean> own(rows.size());
  instance.get_booleans(rows, own);
  std::ranges::transform(own, values.begin(), [](fmi2Boolean value) { return value != fmi2False; });
}

/// Reads values of enumerations and structural parameters, which the variable table stores as fmi2Integer.
template <typename T>
void read(Instance& instance, Rows rows, std::span<T> values) {
  std::vector<fmi2Integer> own(rows.size());
  instance.get(rows, own);
  std::ranges::transform(own, values.begin(), [](fmi2Integer value) { return static_cast<T>(value); });
}

void write(Instance& instance, Rows rows, std::span<const fmi3Float64> values) {
  instance.set(rows, values);
}

void write(Instance& instance, Rows rows, std::span<const fmi3Int32> values) {
  instance.set(rows, values);
}

void write(Instance& instance, Rows rows, std::span<const fmi3String> values) {
  instance.set(rows, values);
}

void write(Instance& instance, Rows rows, std::span<const fmi3Boolean> values) {
  std::vector<fmi2Boolean> own(rows.size());
  std::ranges::transform(values, own.begin(), [](bool value) { return value ? fmi2True : fmi2False; });
  instance.set_booleans(rows, own);
}

template <typename T>
void write(Instance& instance, Rows rows, std::span<const T> values) {
  std::vector<fmi2Integer> own;
  for (const T value : values) {
    if (!std::in_range<fmi2Integer>(value))
      throw Error(fmt::format("{} = {}: this variable holds numbers of 32 bits",
                              instance.definition().variables[rows[own.size()]].name, value));
    own.push_back(static_cast<fmi2Integer>(value));
  }
  instance.set(rows, own);
}

void check_may_set(const Instance& instance, Rows rows) {
  const auto& variables = instance.definition().variables;
  const bool configures = instance.state() == State::configuration;
  for (const fmi2ValueReference row : rows) {
    if (row == variables.size()) throw Error("time is the independent variable, which only a step changes");
    if (variables[row].is_structural == configures) continue;
    const std::string_view name = variables[row].name;
    throw Error(
        configures
            ? fmt::format("{} is not a structural parameter: leave configuration mode before you set it", name)
            : fmt::format("{} is a structural parameter: call fmi3EnterConfigurationMode before you set it", name));
  }
}

template <typename T>
constexpr bool kHasVariables =
    std::is_same_v<T, fmi3Float64> || std::is_same_v<T, fmi3Int32> || std::is_same_v<T, fmi3Int64> ||
    std::is_same_v<T, fmi3UInt64> || std::is_same_v<T, fmi3Boolean> || std::is_same_v<T, fmi3String>;

/// Refuses a call for a type that no variable of MEbots' FMUs has. Succeeds only if the list of references is empty.
fmi3Status refuse_values(fmi3Instance handle, const Function& function, std::string_view type,
                         const fmi3ValueReference references[], std::size_t count, std::size_t value_count) {
  return guarded3(handle, function, [&](Instance& instance) {
    rows_of(instance, checked_array(references, count, "valueReferences"), type, value_count);
  });
}

template <typename T>
fmi3Status get_values(fmi3Instance handle, const Function& function, std::string_view type,
                      const fmi3ValueReference references[], std::size_t count, T values[], std::size_t value_count) {
  if constexpr (kHasVariables<T>)
    return guarded3(handle, function, [&](Instance& instance) {
      const auto rows = rows_of(instance, checked_array(references, count, "valueReferences"), type, value_count);
      read(instance, rows, checked_array(values, value_count, "values"));
    });
  else
    return refuse_values(handle, function, type, references, count, value_count);
}

template <typename T>
fmi3Status set_values(fmi3Instance handle, const Function& function, std::string_view type,
                      const fmi3ValueReference references[], std::size_t count, const T values[],
                      std::size_t value_count) {
  if constexpr (kHasVariables<T>)
    return guarded3(handle, function, [&](Instance& instance) {
      const auto rows = rows_of(instance, checked_array(references, count, "valueReferences"), type, value_count);
      check_may_set(instance, rows);
      write(instance, rows, checked_array(values, value_count, "values"));
    });
  else
    return refuse_values(handle, function, type, references, count, value_count);
}

}  // namespace

std::vector<fmi2ValueReference> rows_of(const Instance& instance, std::span<const fmi3ValueReference> references,
                                        std::string_view type, std::size_t value_count) {
  constexpr fmi2ValueReference kPartsOfBinary = 3;
  const auto& variables = instance.definition().variables;
  std::vector<fmi2ValueReference> rows;
  rows.reserve(value_count);
  for (const fmi3ValueReference reference : references) {
    const bool is_time = reference == variables.size();
    if (!is_time && (reference > variables.size() || variables[reference].elements == 0))
      throw Error(fmt::format("there is no variable with the value reference {}; modelDescription.xml of {} lists them",
                              reference, instance.definition().model_identifier));
    const std::string_view own_type = is_time ? "Float64" : type_word(variables[reference]);
    if (own_type != type)
      throw Error(fmt::format("value reference {} is {} of type {}, not {}; use the functions for {}", reference,
                              is_time ? "time" : variables[reference].name, own_type, type, own_type));
    const std::size_t elements = is_time ? 1 : instance.elements_of(variables[reference]);
    const fmi2ValueReference stride = own_type == "Binary" ? kPartsOfBinary : 1;
    for (fmi2ValueReference i = 0; i < elements; ++i) rows.push_back(reference + i * stride);
  }
  if (rows.size() != value_count)
    throw Error(fmt::format("{} values for variables of {} elements together", value_count, rows.size()));
  return rows;
}

}  // namespace mebots::shell

using mebots::Error;
using namespace mebots::shell;  // NOLINT(google-build-using-namespace): the functions below are the standard's, and
                                // global

// NOLINTBEGIN(bugprone-macro-parentheses): names of functions and types
#define MEBOTS_DEFINE(name, type)                                                                             \
  fmi3Status fmi3Get##name(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,   \
                           type values[], std::size_t value_count) {                                          \
    return get_values(instance, {"fmi3Get" #name, kReadable}, #name, references, count, values, value_count); \
  }                                                                                                           \
  fmi3Status fmi3Set##name(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,   \
                           const type values[], std::size_t value_count) {                                    \
    return set_values(instance, {"fmi3Set" #name, kSettable}, #name, references, count, values, value_count); \
  }
// NOLINTEND(bugprone-macro-parentheses)
MEBOTS_FMI3_EACH_NUMBER_TYPE(MEBOTS_DEFINE)
MEBOTS_DEFINE(String, fmi3String)
#undef MEBOTS_DEFINE

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                         std::size_t sizes[], fmi3Binary values[], std::size_t value_count) {
  return guarded3(instance, {"fmi3GetBinary", kReadable}, [&](Instance& own) {
    const auto rows = rows_of(own, checked_array(references, count, "valueReferences"), "Binary", value_count);
    const auto all_sizes = checked_array(sizes, value_count, "valueSizes");
    const auto all_values = checked_array(values, value_count, "values");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto bytes = own.get_binary(rows[i]);
      all_sizes[i] = bytes.size();
      all_values[i] = bytes.data();
    }
  });
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                         const std::size_t sizes[], const fmi3Binary values[], std::size_t value_count) {
  return guarded3(instance, {"fmi3SetBinary", kSettable}, [&](Instance& own) {
    const auto rows = rows_of(own, checked_array(references, count, "valueReferences"), "Binary", value_count);
    const auto all_sizes = checked_array(sizes, value_count, "valueSizes");
    const auto all_values = checked_array(values, value_count, "values");
    check_may_set(own, rows);
    for (std::size_t i = 0; i < rows.size(); ++i)
      own.set_binary(rows[i], checked_array(all_values[i], all_sizes[i], "values[i]"));
  });
}

// MEbots' FMUs have no Clocks, so these functions accept no reference.

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count, fmi3Clock[]) {
  return refuse_values(instance, {"fmi3GetClock", kReadable}, "Clock", references, count, count);
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                        const fmi3Clock[]) {
  return refuse_values(instance, {"fmi3SetClock", kSettable}, "Clock", references, count, count);
}
