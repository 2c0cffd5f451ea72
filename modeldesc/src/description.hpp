// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

/// description.json, read and checked: what every generator of ours starts from.
namespace mebots::modeldesc {

enum class FieldType { real, integer, boolean, string, binary, enumeration };

struct Group {
  std::string name;
  std::vector<std::string> words;
  bool is_array = false;    // FMI 3.0 has one variable for all words
  std::string size_source;  // name of the parameter with the array's number of elements; empty = one per word
};

struct Enumeration {
  std::string name;
  std::vector<EnumerationItem> items;
};

/// One entry of `variables`: a C++ field (an array for a group) and the FMI variables that it stands for.
struct Field {
  std::string name;                    // as written, `{load}.power`
  std::optional<std::size_t> group;    // index in Description::groups
  std::vector<std::string> fmi_names;  // one, or one per word of the group
  std::string cpp_name;                // `load_power_w`; empty when on_demand
  FieldType type = FieldType::real;
  std::string enumeration;  // name of the type when it is one
  Causality causality = Causality::parameter;
  Variability variability = Variability::fixed;
  std::string unit;
  std::vector<Value> starts;  // as many as fmi_names; empty when there is none
  std::optional<double> min;
  std::optional<double> max;
  std::optional<double> nominal;
  std::string text;
  std::vector<std::string> depends_on;                       // FMI names of inputs, groups taken apart
  std::optional<std::vector<std::string>> first_depends_on;  // of the value at t = 0; nothing: on any input
  std::string mime_type;
  bool on_demand = false;
};

/// The whole number that a value holds; 0 for other kinds.
inline std::int64_t whole_number_of(const Value& value) {
  return std::visit(
      [](const auto& held) -> std::int64_t {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_integral_v<Held> && !std::is_same_v<Held, bool>) return held;
        return 0;
      },
      value);
}

/// A bundle of variables that a tool connects at once: a terminal of FMI 3.0.
struct Terminal {
  struct Member {
    std::string name;
    std::size_t field = 0;    // index in Description::fields
    std::size_t element = 0;  // of the field, if its group is no array
  };
  std::string name;
  std::string text;
  std::string kind;
  std::string matching_rule = "bus";
  std::vector<Member> members;
};

/// Versions of FMI that an FMU can be built for.
enum class FmiVersion { two = 2, three = 3 };

struct Description {
  std::string source;           // file name without folder
  std::vector<FmiVersion> fmi;  // empty = 2.0
  std::string name;
  std::string text;
  std::string cpp_namespace;
  double step_s = 0;
  double stop_time_s = 0;
  std::vector<LogCategory> log_categories;
  std::vector<Group> groups;
  std::vector<Enumeration> enumerations;
  std::vector<Field> fields;
  std::vector<Terminal> terminals;

  const Enumeration& enumeration(std::string_view name) const;
};

/// Reads description.json and, when `board` is not empty, joins the variables and enumerations of the board's
/// devices to it. Throws mebots::Error naming everything that is wrong, with file, line and key.
Description read_description(const std::filesystem::path& file, const std::filesystem::path& board = {});

/// Reads the variables and enumerations of a board's devices alone. Throws mebots::Error naming everything that is
/// wrong with them.
void check_board_variables(const std::filesystem::path& board);

/// The parts of an OSMP binary, in the order in which they get value references.
inline constexpr std::array<std::string_view, 3> kOsmpRoles = {"base.lo", "base.hi", "size"};

}  // namespace mebots::modeldesc
