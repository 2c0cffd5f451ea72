// SPDX-License-Identifier: Apache-2.0
#include "description.hpp"

#include "copies.hpp"
#include "fmi3_keys.hpp"
#include "generate.hpp"
#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace mebots::modeldesc {
namespace {

using data::Node;
using data::Object;

/// Builds a Description and rejects duplicate names. Adds mistakes to the documents of the nodes.
class DescriptionReader {
 public:
  void read_own(const Node& root, const std::filesystem::path& file) {
    Object object(root);
    result_.source = file.filename().string();
    object.comment("$schema");
    object.read("name", result_.name, [](const Node& node) {
      auto name = node.text();
      if (is_cpp_identifier(name)) return name;
      node.fail(ErrorCode::invalid_value,
                fmt::format("{} must name a library and C functions: use letters, digits and _", node.shown()));
    });
    object.read("text", result_.text, &xml_text);
    object.read_if("namespace", result_.cpp_namespace, [](const Node& node) {
      auto name = node.text();
      if (name.empty() || is_cpp_namespace(name)) return name;  // an empty name is the global namespace
      node.fail(ErrorCode::invalid_value, fmt::format("{} is not a C++ namespace", node.shown()));
    });
    object.read_if("fmi", result_.fmi, &read_fmi_versions);
    object.read("step", result_.step_s, data::number(data::Limits::positive()));
    object.read("stop_time", result_.stop_time_s, data::number(data::Limits::positive()));
    object.visit_if("log_categories", [this](const Node& node) {
      for (const auto& [name, text] : node.members()) {
        text.attempt([&, &name = name, &text = text] {
          check_xml_text(text, name);
          result_.log_categories.push_back({name, xml_text(text)});
        });
      }
    });
    object.visit_if("groups", [this](const Node& node) { read_groups(node); });
    object.visit_if("arrays", [this](const Node& node) { size_sources_ = read_arrays(node, result_.groups); });
    object.visit_if("repeat", [this](const Node& node) { repeat_.emplace(read_repeat(node, result_)); });
    object.visit_if("enumerations", [this](const Node& node) { read_enumerations(node); });
    object.visit("variables", [this](const Node& node) { read_variables(node); });
    object.visit_if("terminals", [this](const Node& node) { terminals_.push_back(node); });
    object.finish();
  }

  /// Reads the variables of a board's devices. Ignores the other members, which fmu_soc reads.
  void join_board(const Node& root, const std::filesystem::path& file) {
    for (const auto& device : root.at("devices").elements()) {
      device.attempt([&] {
        if (const auto types = device.find("enumerations")) types->attempt([&] { read_enumerations(*types); });
        if (const auto variables = device.find("variables")) variables->attempt([&] { read_variables(*variables); });
        if (const auto terminals = device.find("terminals")) terminals_.push_back(*terminals);
      });
    }
    result_.source += " and " + file.filename().string();
  }

  /// Resolves references to variables. Call this function after all variables were read.
  void read_references() {
    check_dependencies();
    for (const auto& [group, node] : size_sources_) check_size_source(node, group, result_);
    for (const auto& node : terminals_) read_terminals(node, result_);
    if (repeat_) check_repeat(*repeat_, result_);
  }

  Description take() { return std::move(result_); }

 private:
  using Names = std::map<std::string, std::string>;  // maps a name to the place of its declaration

  void check_dependencies() const {
    for (const auto& [node, names] : dependencies_) {
      for (const auto& name : names) {
        if (inputs_.contains(name)) continue;
        const std::vector<std::string> known(inputs_.begin(), inputs_.end());
        node.complain_unknown("the input", name, known);
      }
    }
  }

  void read_groups(const Node& node) {
    for (const auto& [name, words] : node.members()) {
      words.attempt([&, &name = name, &words = words] {
        check_cpp_name(words, name);
        claim(cpp_names_, name, words);
        result_.groups.push_back({name, data::list_of(&read_word)(words), false, ""});
        if (words.elements().empty()) words.fail(ErrorCode::invalid_value, "a group needs at least one word");
      });
    }
  }

  static std::string read_word(const Node& node) {
    auto word = node.text();
    if (!is_structured_name(word)) {
      node.fail(ErrorCode::invalid_value, fmt::format("{} is not part of a variable's name", node.shown()));
    }
    return word;
  }

  void read_enumerations(const Node& node) {
    for (const auto& [name, items] : node.members()) {
      items.attempt([&, &name = name, &items = items] {
        check_cpp_name(items, name);
        claim(cpp_names_, name, items);
        result_.enumerations.push_back({name, read_items(items)});
      });
    }
  }

  static std::vector<EnumerationItem> read_items(const Node& node) {
    std::vector<EnumerationItem> items;
    std::map<std::int32_t, std::string> values;
    for (const auto& [name, member] : node.members()) {
      member.attempt([&, &name = name, &member = member] {
        check_cpp_name(member, name);
        const std::int32_t value = integer(member);
        const auto [other, is_new] = values.emplace(value, name);
        if (!is_new) {
          member.fail(ErrorCode::duplicate_name,
                      fmt::format("{} and {} have the same value {}", other->second, name, value));
        }
        items.push_back({name, value, ""});
      });
    }
    if (node.members().empty()) node.fail(ErrorCode::invalid_value, "an enumeration needs at least one item");
    std::ranges::sort(items, {}, &EnumerationItem::value);  // the same order as on the chip
    return items;
  }

  void read_variables(const Node& node) {
    if (node.elements().empty()) {
      node.fail(ErrorCode::invalid_value, "the list is empty; FMI 2.0 requires at least one variable");
    }
    for (const auto& entry : node.elements()) {
      entry.attempt([&] { read_variable(entry); });
    }
  }

  void read_variable(const Node& node) {
    static const auto causality = data::word_of<Causality>(
        {{"parameter", Causality::parameter}, {"input", Causality::input}, {"output", Causality::output}});
    Object object(node);
    Field field;
    bool sound = object.read("name", field.name, &Node::readable_text);
    object.read("text", field.text, &xml_text);
    sound &= read_type(object, field);
    sound &= object.read("causality", field.causality, causality);
    object.allow({"variability", "unit", "start", "min", "max", "nominal", "depends_on", "first_depends_on",
                  "mime_type", "on_demand", "copies", "start_of_many"});
    object.finish();
    if (!sound) return;  // further checks could depend on wrong values
    node.attempt([&] { read_names(node, field); });
    read_variability(object, field);
    read_dependencies(object, field);
    read_unit(object, field);
    read_numbers(object, field);
    read_starts(object, field);
    read_kind(object, field);
    read_copies(object, field, result_);
    if (!object.sound()) return;
    if (!field.on_demand) {
      field.cpp_name = cpp_name(field);
      check_cpp_name(node.at("name"), field.cpp_name);
      // Requires a unique name in all three generated structs. C++ would accept equal names in two structs, but readers
      // of the code might confuse them.
      claim(cpp_names_, field.cpp_name, node.at("name"));
    }
    result_.fields.push_back(std::move(field));
  }

  /// Reads the key `type`. The default is Real. Returns false if the type is unknown.
  bool read_type(Object& object, Field& field) const {
    static constexpr std::array<std::pair<std::string_view, FieldType>, 5> kTypes{{{"Real", FieldType::real},
                                                                                   {"Integer", FieldType::integer},
                                                                                   {"Boolean", FieldType::boolean},
                                                                                   {"String", FieldType::string},
                                                                                   {"Binary", FieldType::binary}}};
    const bool absent = !object.has("type");
    return object.read_if("type", field.type, [&](const Node& node) {
      const auto type = node.text();
      std::vector<std::string> known;
      for (const auto& [name, meaning] : kTypes) {
        if (name == type) return meaning;
        known.emplace_back(name);
      }
      for (const auto& enumeration : result_.enumerations) known.push_back(enumeration.name);
      if (std::ranges::find(result_.enumerations, type, &Enumeration::name) == result_.enumerations.end()) {
        node.fail_unknown("the type", type, known);
      }
      field.enumeration = type;
      return FieldType::enumeration;
    }) || absent;
  }

  static void read_variability(Object& object, Field& field) {
    static const auto words = data::word_of<Variability>({{"fixed", Variability::fixed},
                                                          {"tunable", Variability::tunable},
                                                          {"discrete", Variability::discrete},
                                                          {"continuous", Variability::continuous}});
    const bool parameter = field.causality == Causality::parameter;
    const bool real = field.type == FieldType::real;
    field.variability = parameter ? Variability::fixed : real ? Variability::continuous : Variability::discrete;
    object.read_if("variability", field.variability, [&](const Node& node) {
      const auto found = words(node);
      const bool of_parameter = found == Variability::fixed || found == Variability::tunable;
      if (of_parameter != parameter || (found == Variability::continuous && !real)) {
        node.fail(ErrorCode::invalid_value,
                  fmt::format("{} is not possible with this causality and type; parameters are fixed or tunable, other "
                              "variables discrete, or continuous if Real",
                              node.shown()));
      }
      return found;
    });
    if (field.type == FieldType::binary && parameter) {
      object.node().at("causality").complain(ErrorCode::invalid_value, "a Binary cannot be a parameter");
    }
  }

  /// Reads the names of the inputs on which an output depends. Expands groups in the names.
  void read_dependencies(Object& object, Field& field) {
    const auto names = [&](const Node& node) {
      if (field.causality != Causality::output) node.fail(ErrorCode::invalid_value, "this key is for outputs only");
      std::vector<std::string> result;
      for (const auto& element : node.elements()) {
        element.attempt([&] {
          const auto expanded = expand(element, element.text()).second;
          dependencies_.emplace_back(element, expanded);
          result.insert(result.end(), expanded.begin(), expanded.end());
        });
      }
      return result;
    };
    object.read_if("depends_on", field.depends_on, names);
    object.read_if("first_depends_on", field.first_depends_on, names);
  }

  /// Expands `{group}` in a name. Returns the group's index and one name per word of the group. Returns a name without
  /// a group unchanged.
  std::pair<std::optional<std::size_t>, std::vector<std::string>> expand(const Node& node,
                                                                         const std::string& name) const {
    const auto open = name.find('{');
    if (open == std::string::npos) return {std::nullopt, {name}};
    const auto close = name.find('}', open);
    if (close == std::string::npos || name.find('{', open + 1) != std::string::npos) {
      node.fail(ErrorCode::invalid_value, "a name may contain only one {group}");
    }
    const std::string group_name = name.substr(open + 1, close - open - 1);
    const auto group = std::ranges::find(result_.groups, group_name, &Group::name);
    if (group == result_.groups.end()) node.fail_unknown("the group", group_name, names_of(result_.groups));
    std::vector<std::string> names;
    for (const std::string& word : group->words) names.push_back(name.substr(0, open) + word + name.substr(close + 1));
    return {static_cast<std::size_t>(group - result_.groups.begin()), names};
  }

  void read_names(const Node& variable, Field& field) {
    const Node node = variable.at("name");
    std::tie(field.group, field.fmi_names) = expand(node, field.name);
    field.words = field.fmi_names.size();
    for (const std::string& name : field.fmi_names) {
      if (!is_structured_name(name)) {
        node.fail(ErrorCode::invalid_value,
                  fmt::format("\"{}\" is not a structured FMI name such as cell.voltage or rotor[1].thrust", name));
      }
      if (field.type == FieldType::binary) {
        for (const std::string_view role : kOsmpRoles) claim(fmi_names_, fmt::format("{}.{}", name, role), node);
      }
      claim(fmi_names_, name, node);
      if (field.causality == Causality::input) inputs_.insert(name);
    }
  }

  static void read_unit(Object& object, Field& field) {
    if (field.type != FieldType::real) {
      refuse(object, "unit", "this key is for Real only");
      return;
    }
    object.read("unit", field.unit, [](const Node& node) {
      auto unit = node.text();
      try {
        static_cast<void>(parse_unit(unit));
      } catch (const Error& error) {
        node.fail(error.code(), error.what());
      }
      return unit;
    });
  }

  static void read_numbers(Object& object, Field& field) {
    const bool real = field.type == FieldType::real;
    if (!real && field.type != FieldType::integer) {
      refuse(object, "min", "this key is for Real and Integer only");
      refuse(object, "max", "this key is for Real and Integer only");
    } else {
      object.read_if("min", field.min, data::number());
      object.read_if("max", field.max, data::number());
    }
    if (real) {
      object.read_if("nominal", field.nominal, data::number(data::Limits::positive()));
    } else {
      refuse(object, "nominal", "this key is for Real only");
    }
    if (field.min && field.max && *field.min > *field.max) {
      object.node().at("min").complain(ErrorCode::invalid_value,
                                       fmt::format("min {} is above max {}", *field.min, *field.max));
    }
  }

  void read_starts(Object& object, Field& field) const {
    const bool wanted = field.causality != Causality::output && field.type != FieldType::binary;
    if (!wanted) {
      refuse(object, "start",
             "this key is for parameters and inputs: the model computes outputs, and a Binary starts as null");
      return;
    }
    const auto starts = [&](const Node& start) {
      if (!start.is(data::Kind::list)) {
        return std::vector<Value>(field.fmi_names.size(), start_value(start, field));
      }
      const auto elements = start.elements();
      if (!field.group || elements.size() != field.fmi_names.size()) {
        start.fail(ErrorCode::invalid_value,
                   fmt::format("{} values for {} variables", elements.size(), field.fmi_names.size()));
      }
      return data::list_of([&](const Node& value) { return start_value(value, field); })(start);
    };
    object.read("start", field.starts, starts);
    object.read_if("start_of_many", field.other_starts, starts);
  }

  Value start_value(const Node& node, const Field& field) const {
    switch (field.type) {
      case FieldType::real:
        check_limits(node, field, node.number());
        return node.number();
      case FieldType::integer: {
        const std::int32_t number = integer(node);
        check_limits(node, field, number);
        return number;
      }
      case FieldType::enumeration: {
        const std::int32_t number = integer(node);
        const auto& items = result_.enumeration(field.enumeration).items;
        if (std::ranges::find(items, number, &EnumerationItem::value) == items.end()) {
          node.fail(ErrorCode::value_out_of_range, fmt::format("{} is not a value of {}", number, field.enumeration));
        }
        return number;
      }
      case FieldType::boolean:
        return node.flag();
      case FieldType::string:
        return xml_text(node);
      case FieldType::binary:
        break;
    }
    return {};
  }

  static void read_kind(Object& object, Field& field) {
    if (field.type == FieldType::binary) {
      object.read("mime_type", field.mime_type, &xml_text);
    } else {
      refuse(object, "mime_type", "this key is for Binary only");
    }
    object.read_if("on_demand", field.on_demand, [&](const Node& node) {
      const bool on_demand = node.flag();
      if (on_demand && (field.type != FieldType::string || field.causality != Causality::output)) {
        node.fail(ErrorCode::invalid_value, "this key is for String outputs only");
      }
      return on_demand;
    });
  }

  static void check_limits(const Node& node, const Field& field, double value) {
    if (field.min && value < *field.min) {
      node.fail(ErrorCode::value_out_of_range, fmt::format("{} is below min {}", value, *field.min));
    }
    if (field.max && value > *field.max) {
      node.fail(ErrorCode::value_out_of_range, fmt::format("{} is above max {}", value, *field.max));
    }
  }

  static std::int32_t integer(const Node& node) {
    using Limits = std::numeric_limits<std::int32_t>;
    return static_cast<std::int32_t>(node.whole_number(Limits::min(), Limits::max()));
  }

  static void refuse(const Object& object, std::string_view key, std::string_view why) {
    if (const auto member = object.node().find(key)) member->complain(ErrorCode::invalid_value, why);
  }

  static void check_cpp_name(const Node& node, const std::string& name) {
    if (!is_cpp_identifier(name)) node.fail(ErrorCode::invalid_value, fmt::format("\"{}\" is not a C++ name", name));
  }

  std::string cpp_name(const Field& field) const {
    std::string name = field.name;
    if (field.group) {
      const std::string& group = result_.groups[*field.group].name;
      const auto open = name.find('{');
      // If {group} is at the start of the name, the C++ name contains the group's name (load_power_w). Otherwise the
      // C++ name omits it (drone_position_m).
      name.replace(open, group.size() + 2, open == 0 ? group : "");
    }
    return to_cpp_name(name) + (field.unit.empty() ? "" : unit_suffix(field.unit));
  }

  static void claim(Names& names, const std::string& name, const Node& node) {
    const auto [found, is_new] = names.emplace(name, node.place());
    if (is_new) return;
    node.fail(ErrorCode::duplicate_name, fmt::format("the name {} is already taken by {}", name, found->second));
  }

  Description result_;
  Names fmi_names_;
  Names cpp_names_;
  std::set<std::string> inputs_;
  std::vector<std::pair<Node, std::vector<std::string>>> dependencies_;
  std::map<std::string, Node> size_sources_;  // by group: nodes that name the size parameter of an array
  std::vector<Node> terminals_;
  std::optional<Node> repeat_;
};

}  // namespace

const Enumeration& Description::enumeration(std::string_view type) const {
  const auto found = std::ranges::find(enumerations, type, &Enumeration::name);
  if (found == enumerations.end())
    throw Error(ErrorCode::unknown_name, fmt::format("there is no enumeration {}", type));
  return *found;
}

Description read_description(const std::filesystem::path& file, const std::filesystem::path& board,
                             std::size_t copies) {
  data::Document own(file);
  std::optional<data::Document> joined;
  if (!board.empty()) joined.emplace(board);
  DescriptionReader reader;
  own.read([&](const Node& root) {
    reader.read_own(root, file);
    const auto read_references = [&] {
      if (root.noted() == 0) reader.read_references();  // otherwise variables may be missing
    };
    if (!joined) {
      read_references();
      return;
    }
    joined->read([&](const Node& board_root) {
      reader.join_board(board_root, board);
      if (board_root.noted() == 0) read_references();
    });
  });
  Description description = reader.take();
  make_copies(description, copies);
  return description;
}

void check_board_variables(const std::filesystem::path& board) {
  DescriptionReader reader;
  data::Document(board).read([&](const Node& root) { reader.join_board(root, board); });
}

}  // namespace mebots::modeldesc
