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

/// The checked content of description.json. generate() writes all its files from this content.
namespace mebots::modeldesc {

enum class FieldType { real, integer, boolean, string, binary, enumeration };

struct Group {
  std::string name;
  std::vector<std::string> words;
  bool is_array = false;    // in FMI 3.0, all words form one array variable
  std::string size_source;  // name of the parameter that sets the number of elements; empty: one element per word
};

struct Enumeration {
  std::string name;
  std::vector<EnumerationItem> items;
};

/// The object of which an FMU may have several copies, such as a drone. With several copies, the variables of each copy
/// have names such as `drone[2].mass`.
struct Repeat {
  std::string word;
  std::string size_source;  // name of the parameter that sets the number of copies in use
  std::size_t count = 1;
};

/// An entry of `variables`: a C++ field (an array for a group) and its FMI variables.
struct Field {
  std::string name;                    // name in description.json, such as `{load}.power`
  std::optional<std::size_t> group;    // index in Description::groups
  std::vector<std::string> fmi_names;  // one per word of the group, for each copy in turn
  std::size_t words = 1;               // number of words in the group; 1 without a group
  bool is_shared = false;              // all copies of the repeated object share this variable
  bool only_if_many = false;           // an FMU with one copy lacks this variable; fmi_names is then empty
  std::string cpp_name;                // such as `load_power_w`; empty for on-demand variables
  FieldType type = FieldType::real;
  std::string enumeration;  // type name of an enumeration; otherwise empty
  Causality causality = Causality::parameter;
  Variability variability = Variability::fixed;
  std::string unit;
  std::vector<Value> starts;  // one per word of the group; empty if there are no start values
  /// The start value of an FMU of several copies; in a description of several copies, that of an FMU of one. Empty if
  /// both FMUs have the same start value.
  std::vector<Value> other_starts;
  std::optional<double> min;
  std::optional<double> max;
  std::optional<double> nominal;
  std::string text;
  std::vector<std::string> depends_on;                       // FMI names of inputs; groups are expanded
  std::optional<std::vector<std::string>> first_depends_on;  // the same at t = 0; empty: any input
  std::string mime_type;
  bool on_demand = false;
};

inline std::int64_t whole_number_of(const Value& value) {
  return std::visit(
      [](const auto& held) -> std::int64_t {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_integral_v<Held> && !std::is_same_v<Held, bool>) return held;
        return 0;
      },
      value);
}

/// A terminal of FMI 3.0: a set of variables that a tool connects together.
struct Terminal {
  struct Member {
    std::string name;
    std::size_t field = 0;    // index in Description::fields
    std::size_t element = 0;  // index in the field, if its group is not an array
  };
  std::string name;
  std::string text;
  std::string kind;
  std::string matching_rule = "bus";
  std::vector<Member> members;
};

enum class FmiVersion { two = 2, three = 3 };

struct Description {
  std::string source;           // file name without folder
  std::vector<FmiVersion> fmi;  // versions to generate; empty: only 2.0
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
  std::optional<Repeat> repeat;

  const Enumeration& enumeration(std::string_view name) const;
  bool has_copies(const Field& field) const { return repeat && repeat->count > 1 && !field.is_shared; }
};

/// Reads description.json. If `board` is not empty, adds the variables and enumerations of the board's devices.
/// `copies` is the number of copies of the repeated object. Throws a mebots::Error with all mistakes, each with file,
/// line and key.
Description read_description(const std::filesystem::path& file, const std::filesystem::path& board = {},
                             std::size_t copies = 1);

/// Reads the variables and enumerations of a board's devices, to check them. Throws a mebots::Error with all mistakes.
void check_board_variables(const std::filesystem::path& board);

/// The parts of an OSMP binary variable, in the order of their value references.
inline constexpr std::array<std::string_view, 3> kOsmpRoles = {"base.lo", "base.hi", "size"};

}  // namespace mebots::modeldesc
