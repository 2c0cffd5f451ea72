// SPDX-License-Identifier: Apache-2.0
#include "description.hpp"

#include "cpp_names.hpp"
#include "json_object.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace mebots::modeldesc {
namespace {

/// Builds a Description piece by piece and keeps the names unique.
class DescriptionReader {
 public:
  void read_own(const std::filesystem::path& file) {
    const Json json = read_json(file);
    const JsonObject object(json, file.string());
    object.allow_only(
        {"name", "text", "namespace", "step", "stop_time", "log_categories", "groups", "enumerations", "variables"});
    result_.source = file.filename().string();
    result_.name = object.text("name");
    if (!is_cpp_identifier(result_.name))
      object.fail(fmt::format("\"name\" is {}, but it names a library and C functions: use letters, digits and _",
                              cpp_literal(result_.name)));
    result_.text = object.text("text");
    result_.cpp_namespace = object.text("namespace");
    if (!is_cpp_namespace(result_.cpp_namespace))
      object.fail(fmt::format("\"namespace\" is \"{}\", which is no C++ namespace", result_.cpp_namespace));
    result_.step_s = positive(object, "step");
    result_.stop_time_s = positive(object, "stop_time");
    if (object.has("log_categories")) read_log_categories(object);
    if (object.has("groups")) read_groups(object);
    if (object.has("enumerations")) read_enumerations(object);
    read_variables(object);
  }

  void join_board(const std::filesystem::path& file) {
    const Json json = read_json(file);
    const JsonObject board(json, file.string());
    for (const Json& entry : board.list("devices")) {
      const JsonObject unnamed(entry, board.where());
      const JsonObject device(entry, fmt::format("{}, device {}", board.where(), unnamed.text("name")));
      if (device.has("enumerations")) read_enumerations(device);
      if (device.has("variables")) read_variables(device);
    }
    result_.source += " and " + file.filename().string();
  }

  Description finish() {
    for (const Field& field : result_.fields) {
      check_inputs(field, "depends_on", field.depends_on);
      if (field.first_depends_on) check_inputs(field, "first_depends_on", *field.first_depends_on);
    }
    return std::move(result_);
  }

 private:
  void check_inputs(const Field& field, const char* key, const std::vector<std::string>& names) const {
    for (const std::string& name : names)
      if (!inputs_.contains(name))
        throw Error(fmt::format("{}: {} names {}, which is no input", where_.at(field.name), key, name));
  }

  static double positive(const JsonObject& object, std::string_view key) {
    const double value = object.number(key);
    if (!(value > 0)) object.fail(fmt::format("\"{}\" is {} s; it must be above 0", key, value));
    return value;
  }

  void read_log_categories(const JsonObject& object) {
    const JsonObject categories(object.at("log_categories"), object.where() + ", log_categories");
    for (const auto& item : categories.json().items())
      result_.log_categories.push_back({item.key(), categories.text(item.key())});
  }

  void read_groups(const JsonObject& object) {
    const JsonObject groups(object.at("groups"), object.where() + ", groups");
    for (const auto& item : groups.json().items()) {
      Group group{item.key(), {}};
      if (!is_cpp_identifier(group.name)) groups.fail(fmt::format("\"{}\" is no C++ name", group.name));
      for (const Json& word : groups.list(item.key())) {
        if (!word.is_string() || !is_structured_name(word.get<std::string>()))
          groups.fail(fmt::format("{} in \"{}\" is not part of a variable's name", word.dump(), group.name));
        group.words.push_back(word.get<std::string>());
      }
      if (group.words.empty()) groups.fail(fmt::format("\"{}\" has no words", group.name));
      claim(cpp_names_, group.name, groups.where());
      result_.groups.push_back(std::move(group));
    }
  }

  void read_enumerations(const JsonObject& object) {
    const JsonObject types(object.at("enumerations"), object.where() + ", enumerations");
    for (const auto& item : types.json().items()) {
      const JsonObject items(item.value(), fmt::format("{}, {}", types.where(), item.key()));
      Enumeration type{item.key(), {}};
      if (!is_cpp_identifier(type.name)) types.fail(fmt::format("\"{}\" is no C++ name", type.name));
      std::map<std::int32_t, std::string> values;
      for (const auto& entry : items.json().items()) {
        if (!is_cpp_identifier(entry.key())) items.fail(fmt::format("\"{}\" is no C++ name", entry.key()));
        const std::int32_t value = integer(items, entry.key(), entry.value());
        if (!values.emplace(value, entry.key()).second)
          items.fail(fmt::format("{} and {} have the same value {}", values[value], entry.key(), value));
        type.items.push_back({entry.key(), value, ""});
      }
      if (type.items.empty()) items.fail("an enumeration needs at least one item");
      claim(cpp_names_, type.name, types.where());
      result_.enumerations.push_back(std::move(type));
    }
  }

  void read_variables(const JsonObject& object) {
    if (object.list("variables").empty()) object.fail("\"variables\" is empty; FMI 2.0 asks for one at least");
    for (const Json& entry : object.list("variables")) {
      const JsonObject unnamed(entry, object.where() + ", variables");
      read_variable(JsonObject(entry, fmt::format("{}, variable {}", object.where(), unnamed.text("name"))));
    }
  }

  void read_variable(const JsonObject& json) {
    json.allow_only({"name", "type", "causality", "variability", "unit", "start", "min", "max", "nominal", "text",
                     "depends_on", "first_depends_on", "mime_type", "on_demand"});
    Field field;
    field.name = json.text("name");
    field.text = json.text("text");
    read_type(json, field);
    read_causality(json, field);
    read_names(json, field);
    read_numbers(json, field);
    read_starts(json, field);
    field.on_demand = json.flag("on_demand");
    if (field.on_demand && (field.type != FieldType::string || field.causality != Causality::output))
      json.fail("\"on_demand\" is for String outputs only");
    if (!field.on_demand) {
      field.cpp_name = cpp_name(field);
      if (!is_cpp_identifier(field.cpp_name)) json.fail(fmt::format("\"{}\" is no C++ name", field.cpp_name));
      // Three structs, so the same name in two of them would compile; but it would mislead a reader.
      claim(cpp_names_, field.cpp_name, json.where());
    }
    where_[field.name] = json.where();
    result_.fields.push_back(std::move(field));
  }

  void read_type(const JsonObject& json, Field& field) {
    static const std::map<std::string, FieldType, std::less<>> types = {{"Real", FieldType::real},
                                                                        {"Integer", FieldType::integer},
                                                                        {"Boolean", FieldType::boolean},
                                                                        {"String", FieldType::string},
                                                                        {"Binary", FieldType::binary}};
    const std::string type = json.text_or("type", "Real");
    if (const auto found = types.find(type); found != types.end()) {
      field.type = found->second;
    } else if (std::ranges::find(result_.enumerations, type, &Enumeration::name) != result_.enumerations.end()) {
      field.type = FieldType::enumeration;
      field.enumeration = type;
    } else {
      json.fail(fmt::format("unknown type \"{}\"; use Real, Integer, Boolean, String, Binary or an enumeration", type));
    }
    if (field.type == FieldType::binary)
      field.mime_type = json.text("mime_type");
    else if (json.has("mime_type"))
      json.fail("\"mime_type\" is for Binary only");
  }

  void read_causality(const JsonObject& json, Field& field) {
    const std::string causality = json.text("causality");
    if (causality == "parameter")
      field.causality = Causality::parameter;
    else if (causality == "input")
      field.causality = Causality::input;
    else if (causality == "output")
      field.causality = Causality::output;
    else
      json.fail(fmt::format("\"causality\" is \"{}\"; use parameter, input or output", causality));

    const bool parameter = field.causality == Causality::parameter;
    const bool real = field.type == FieldType::real;
    const std::string fallback = parameter ? "fixed" : real ? "continuous" : "discrete";
    const std::string variability = json.text_or("variability", fallback);
    if (parameter && variability == "fixed")
      field.variability = Variability::fixed;
    else if (parameter && variability == "tunable")
      field.variability = Variability::tunable;
    else if (!parameter && variability == "discrete")
      field.variability = Variability::discrete;
    else if (!parameter && real && variability == "continuous")
      field.variability = Variability::continuous;
    else
      json.fail(
          fmt::format("\"variability\" \"{}\" does not go with causality {} and type {}; parameters are fixed or "
                      "tunable, the rest is discrete, or continuous if Real",
                      variability, causality, json.text_or("type", "Real")));
    if (field.type == FieldType::binary && parameter) json.fail("a Binary cannot be a parameter");
    if (json.has("depends_on")) field.depends_on = read_dependencies(json, "depends_on", field);
    if (json.has("first_depends_on")) field.first_depends_on = read_dependencies(json, "first_depends_on", field);
  }

  /// Names of inputs, groups taken apart.
  std::vector<std::string> read_dependencies(const JsonObject& json, const char* key, const Field& field) const {
    if (field.causality != Causality::output) json.fail(fmt::format("\"{}\" is for outputs only", key));
    std::vector<std::string> result;
    for (const Json& name : json.list(key)) {
      if (!name.is_string()) json.fail(fmt::format("\"{}\" must list names, not {}", key, name.dump()));
      const auto names = expand(json, name.get<std::string>()).second;
      result.insert(result.end(), names.begin(), names.end());
    }
    return result;
  }

  /// Takes `{group}` apart: the group's index and one name per word.
  std::pair<std::optional<std::size_t>, std::vector<std::string>> expand(const JsonObject& json,
                                                                         const std::string& name) const {
    const auto open = name.find('{');
    if (open == std::string::npos) return {std::nullopt, {name}};
    const auto close = name.find('}', open);
    if (close == std::string::npos || name.find('{', open + 1) != std::string::npos)
      json.fail("a name may hold one {group} only");
    const std::string group_name = name.substr(open + 1, close - open - 1);
    const auto group = std::ranges::find(result_.groups, group_name, &Group::name);
    if (group == result_.groups.end()) json.fail(fmt::format("there is no group \"{}\" in \"groups\"", group_name));
    std::vector<std::string> names;
    for (const std::string& word : group->words) names.push_back(name.substr(0, open) + word + name.substr(close + 1));
    return {static_cast<std::size_t>(group - result_.groups.begin()), names};
  }

  void read_names(const JsonObject& json, Field& field) {
    std::tie(field.group, field.fmi_names) = expand(json, field.name);
    for (const std::string& name : field.fmi_names) {
      if (!is_structured_name(name))
        json.fail(fmt::format("\"{}\" is no structured FMI name such as cell.voltage or rotor[1].thrust", name));
      if (field.type == FieldType::binary)
        for (const std::string_view role : kOsmpRoles)
          claim(fmi_names_, fmt::format("{}.{}", name, role), json.where());
      claim(fmi_names_, name, json.where());
      if (field.causality == Causality::input) inputs_.emplace(name, json.where());
    }
  }

  static void read_numbers(const JsonObject& json, Field& field) {
    const bool real = field.type == FieldType::real;
    const bool numeric = real || field.type == FieldType::integer;
    for (const char* key : {"min", "max"})
      if (json.has(key) && !numeric) json.fail(fmt::format("\"{}\" is for Real and Integer only", key));
    for (const char* key : {"unit", "nominal"})
      if (json.has(key) && !real) json.fail(fmt::format("\"{}\" is for Real only", key));
    field.min = json.optional_number("min");
    field.max = json.optional_number("max");
    field.nominal = json.optional_number("nominal");
    if (field.nominal && !(*field.nominal > 0)) json.fail("\"nominal\" must be above 0");
    if (field.min && field.max && *field.min > *field.max)
      json.fail(fmt::format("\"min\" {} is above \"max\" {}", *field.min, *field.max));
    field.unit = json.text_or("unit", "");
    if (real && field.unit.empty()) json.fail("a Real needs a \"unit\"; use \"1\" for a plain number");
    if (real && find_known_unit(field.unit) == nullptr)
      json.fail(
          fmt::format("unknown unit \"{}\"; add it to modeldesc/src/units.cpp or use one from there", field.unit));
  }

  void read_starts(const JsonObject& json, Field& field) const {
    const bool wanted = field.causality != Causality::output && field.type != FieldType::binary;
    if (!wanted) {
      if (json.has("start"))
        json.fail("\"start\" is for parameters and inputs: the model computes outputs, a Binary starts as null");
      return;
    }
    const Json& start = json.at("start");
    if (start.is_array()) {
      if (!field.group || start.size() != field.fmi_names.size())
        json.fail(fmt::format("\"start\" lists {} values for {} variables", start.size(), field.fmi_names.size()));
      for (const Json& value : start) field.starts.push_back(start_value(json, field, value));
    } else {
      field.starts.assign(field.fmi_names.size(), start_value(json, field, start));
    }
  }

  Value start_value(const JsonObject& json, const Field& field, const Json& value) const {
    switch (field.type) {
      case FieldType::real: {
        if (!value.is_number()) json.fail(fmt::format("\"start\" must be a number, not {}", value.dump()));
        check_limits(json, field, value.get<double>());
        return value.get<double>();
      }
      case FieldType::integer: {
        const std::int32_t number = integer(json, "start", value);
        check_limits(json, field, number);
        return number;
      }
      case FieldType::enumeration: {
        const std::int32_t number = integer(json, "start", value);
        const auto& items = result_.enumeration(field.enumeration).items;
        if (std::ranges::find(items, number, &EnumerationItem::value) == items.end())
          json.fail(fmt::format("\"start\" {} is no value of {}", number, field.enumeration));
        return number;
      }
      case FieldType::boolean:
        if (!value.is_boolean()) json.fail(fmt::format("\"start\" must be true or false, not {}", value.dump()));
        return value.get<bool>();
      case FieldType::string:
        if (!value.is_string()) json.fail(fmt::format("\"start\" must be a text, not {}", value.dump()));
        return value.get<std::string>();
      case FieldType::binary:
        break;
    }
    return {};
  }

  static void check_limits(const JsonObject& json, const Field& field, double value) {
    if (field.min && value < *field.min) json.fail(fmt::format("\"start\" {} is below \"min\" {}", value, *field.min));
    if (field.max && value > *field.max) json.fail(fmt::format("\"start\" {} is above \"max\" {}", value, *field.max));
  }

  static std::int32_t integer(const JsonObject& json, std::string_view key, const Json& value) {
    constexpr double kMin = std::numeric_limits<std::int32_t>::min();
    constexpr double kMax = std::numeric_limits<std::int32_t>::max();
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(number >= kMin && number <= kMax) || number != std::floor(number))
      json.fail(fmt::format("\"{}\" must be a whole number of 32 bits, not {}", key, value.dump()));
    return static_cast<std::int32_t>(number);
  }

  std::string cpp_name(const Field& field) const {
    std::string name = field.name;
    if (field.group) {
      const std::string& group = result_.groups[*field.group].name;
      const auto open = name.find('{');
      // At the front the group's name says whose value it is (load_power_w); elsewhere the rest does
      // (drone_position_m).
      name.replace(open, group.size() + 2, open == 0 ? group : "");
    }
    const std::string base = to_cpp_name(name);
    const KnownUnit* unit = find_known_unit(field.unit);
    const std::string suffix = unit == nullptr ? "" : unit->suffix;
    return base + suffix;
  }

  static void claim(std::map<std::string, std::string>& names, const std::string& name, const std::string& where) {
    const auto [found, fresh] = names.emplace(name, where);
    if (!fresh) throw Error(fmt::format("{}: the name {} is already taken by {}", where, name, found->second));
  }

  Description result_;
  std::map<std::string, std::string> fmi_names_;  // name -> where it was declared
  std::map<std::string, std::string> cpp_names_;
  std::map<std::string, std::string> inputs_;
  std::map<std::string, std::string> where_;
};

}  // namespace

const Enumeration& Description::enumeration(std::string_view type) const {
  const auto found = std::ranges::find(enumerations, type, &Enumeration::name);
  if (found == enumerations.end()) throw Error(fmt::format("there is no enumeration {}", type));
  return *found;
}

Description read_description(const std::filesystem::path& file, const std::filesystem::path& board) {
  DescriptionReader reader;
  reader.read_own(file);
  if (!board.empty()) reader.join_board(board);
  return reader.finish();
}

}  // namespace mebots::modeldesc
