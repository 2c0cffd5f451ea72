// SPDX-License-Identifier: Apache-2.0
// Replaces entries with `repeat` by their copies, before the sections are read.
#include "io/config/load_system.hpp"
#include "io/config/sections.hpp"

#include "base/input_text.hpp"
#include "mebots/data/csv.hpp"
#include "mebots/data/mistakes.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "mebots/parsed_number.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace mebots::master::config {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMostCopies = 100'000;      // of one entry
constexpr std::size_t kMostCopiesOfAll = 500'000;  // of all entries, including entries in copies
constexpr const char* kParameters = "parameters";

/// The replacement of a name in braces: `value` for a whole text, `text` for a part of a text.
struct Filling {
  // NOLINTNEXTLINE(google-explicit-constructor): a value is written as it is
  Filling(Json v) : value(std::move(v)), text(value.is_string() ? value.get<std::string>() : value.dump()) {}
  Filling(Json v, std::string t) : value(std::move(v)), text(std::move(t)) {}
  static Filling of_index(Json v) {
    Filling filling(std::move(v));
    filling.is_index = true;
    return filling;
  }

  Json value;
  std::string text;
  bool is_index = false;  // false for a value of a column or list
};

/// For one copy of an entry: the names in braces, and the values that replace them.
using Values = std::vector<std::pair<std::string, Filling>>;

bool is_name(std::string_view text) {
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  return !text.empty() && letter(text.front()) && std::ranges::all_of(text, [&](char c) {
    return letter(c) || std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
}

void check_name(const Node& node, std::string_view name) {
  if (!is_name(name)) {
    node.fail(
        ErrorCode::invalid_value,
        fmt::format("\"{}\" cannot be in braces; a name has letters, digits and _, and begins with no digit", name));
  }
}

/// Checks the name of a value, which must differ from the name of the index.
void check_value_name(const Node& node, std::string_view name, std::string_view index) {
  check_name(node, name);
  if (name == index)
    node.fail(ErrorCode::duplicate_name, fmt::format("there are two values {}; rename the index", name));
}

Json json_of(const Node& node) {
  const auto value = written_value(node);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return *whole;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (node.is(data::Kind::whole_number)) return node.natural_number();
  return node.text();
}

/// True for a text such as 007. It is a name, because JSON has no such number.
bool has_leading_zero(std::string_view cell) {
  if (cell.starts_with('-')) cell.remove_prefix(1);
  return cell.size() > 1 && cell[0] == '0' && std::isdigit(static_cast<unsigned char>(cell[1])) != 0;
}

/// Converts a cell to JSON: a number, a Boolean or a text.
Json json_of(std::string_view cell) {
  if (has_leading_zero(cell)) return std::string(cell);
  if (const auto whole = parsed_number<std::int64_t>(cell)) return *whole;
  if (const auto whole = parsed_number<std::uint64_t>(cell)) return *whole;
  if (const auto number = parsed_number<double>(cell); number && std::isfinite(*number)) return *number;
  if (cell == "true" || cell == "false") return cell == "true";
  return std::string(cell);
}

std::vector<Values> numbers(const Node& node, const std::string& index) {
  const auto ends = node.elements();
  if (ends.size() != 2) {
    node.fail(ErrorCode::invalid_value, "write [first, last], the name of a CSV file, or lists by their names");
  }
  const auto first = ends[0].whole_number(-kMostCopies, kMostCopies);
  const auto last = ends[1].whole_number(first, first + kMostCopies - 1);
  std::vector<Values> rows;
  for (auto number = first; number <= last; ++number) rows.push_back({{index, Filling::of_index(number)}});
  return rows;
}

/// Reads lists of values, such as {"mass": [0.03, 0.031], "x": [0, 1]}.
std::vector<Values> lists(const Node& node, const std::string& index) {
  std::vector<Values> rows;
  bool is_first = true;
  for (const auto& [name, list] : node.members()) {
    check_value_name(list, name, index);
    const auto elements = list.elements();
    if (is_first) {
      for (std::size_t row = 0; row < elements.size(); ++row) rows.push_back({{index, Filling::of_index(row + 1)}});
    } else if (elements.size() != rows.size()) {
      list.fail(ErrorCode::invalid_value,
                fmt::format("this list has {} values, and the first list {}", elements.size(), rows.size()));
    }
    for (std::size_t row = 0; row < rows.size(); ++row) rows[row].emplace_back(name, Filling(json_of(elements[row])));
    is_first = false;
  }
  if (rows.empty())
    node.fail(ErrorCode::invalid_value, "there is no value; write a list, such as {\"mass\": [0.03, 0.031]}");
  return rows;
}

std::vector<Values> table(const Node& node, const std::string& index, Repeats& repeats) {
  const auto file = repeats.folder / node.readable_text();
  if (!is_there(file)) {
    node.fail(ErrorCode::file_not_found,
              fmt::format("there is no file {}; paths are relative to the folder of this file",
                          file.lexically_normal().string()));
  }
  const auto text = input_text(file);
  repeats.source += text;
  data::CsvReader csv(text, file.string());
  for (const auto& name : csv.header()) check_value_name(node, name, index);
  std::vector<Values> rows;
  while (csv.next()) {
    Values row = {{index, Filling::of_index(rows.size() + 1)}};
    for (std::size_t i = 0; i < csv.header().size(); ++i) {
      const auto cell = data::trimmed(csv.cell(i));
      row.emplace_back(csv.header()[i], Filling(json_of(cell), std::string(cell)));
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty()) node.fail(ErrorCode::invalid_value, fmt::format("{} has no row", file.string()));
  return rows;
}

/// Returns all combinations of values, of which those of `second` change fastest. The names in `first` and `second`
/// must differ.
std::vector<Values> product(const Node& node, const std::vector<Values>& first, const std::vector<Values>& second) {
  if (first.empty() || second.empty()) return {};
  for (const auto& [name, value] : second.front()) {
    if (std::ranges::find(first.front(), name, &Values::value_type::first) != first.front().end())
      node.fail(ErrorCode::invalid_value, fmt::format("there are two values {}", name));
  }
  if (first.size() * second.size() > static_cast<std::size_t>(kMostCopies)) {
    node.fail(ErrorCode::value_out_of_range, fmt::format("there are more than {} copies", kMostCopies));
  }
  std::vector<Values> all;
  for (const auto& copy : first) {
    for (const auto& row : second) {
      all.push_back(copy);
      all.back().insert(all.back().end(), row.begin(), row.end());
    }
  }
  return all;
}

/// The section `groups` of a config. A group defines the copies of all entries with `"repeat": "GROUP"`.
class Groups {
 public:
  explicit Groups(Repeats& repeats) : repeats_(repeats) {}

  /// Reads `groups`. A group may refer to groups before it.
  void read(const Node& node) {
    for (const auto& [name, range] : node.members()) {
      check_name(range, name);
      auto& copies = groups_[name];
      range.attempt([&, &range = range] { copies = copies_of(range); });
    }
  }

  /// Returns the values of every copy: all combinations of the indexes, of which the last one changes fastest. If a
  /// group has a mistake, reports it and returns no copies.
  std::vector<Values> copies_of(const Node& node) const {
    if (node.is(data::Kind::text)) return group(node);
    std::vector<Values> copies = {{}};
    if (node.is(data::Kind::list)) {
      for (const auto& part : node.elements()) copies = product(part, copies, copies_of(part));
    } else {
      for (const auto& [index, range] : node.members()) copies = product(range, copies, rows_of(range, index));
    }
    if (!copies.empty() && copies.front().empty())
      node.fail(ErrorCode::invalid_value, "name an index, such as {\"i\": [1, 16]}");
    return copies;
  }

 private:
  std::vector<Values> group(const Node& node) const {
    const auto found = groups_.find(node.text());
    if (found != groups_.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [name, copies] : groups_) known.push_back(name);
    node.fail_unknown("group", node.text(), known);
  }

  std::vector<Values> rows_of(const Node& range, const std::string& index) const {
    check_name(range, index);
    if (range.is(data::Kind::list)) return numbers(range, index);
    return range.is(data::Kind::object) ? lists(range, index) : table(range, index, repeats_);
  }

  Repeats& repeats_;
  std::map<std::string, std::vector<Values>> groups_;
};

/// Adds a member to an object. In `key`, names in braces are already replaced. Throws InputError if the object already
/// has this key.
void add_filled(Json& object, std::string key, Json value) {
  if (object.contains(key))
    throw InputError(ErrorCode::duplicate_name, fmt::format("two keys of one copy become '{}'", key));
  object[std::move(key)] = std::move(value);
}

/// Replaces names in braces. Throws InputError if a name is unknown.
class Filler {
 public:
  explicit Filler(const Values& values) : values_(values) {}

  /// Replaces the names in a text. If the text is only a name in braces, returns its value, for example a number.
  Json filled(const std::string& text) const {
    if (text.size() > 2 && text.front() == '{' && text.find('}') == text.size() - 1) {
      if (const auto value = value_of(std::string_view(text).substr(1, text.size() - 2))) return value->value;
    }
    return filled_text(text);
  }

  std::string filled_text(std::string_view text) const {
    std::string result;
    while (true) {
      const auto begin = text.find('{');
      const auto end = begin == std::string_view::npos ? begin : text.find('}', begin);
      if (end == std::string_view::npos) return result.append(text);
      const auto value = value_of(text.substr(begin + 1, end - begin - 1));
      if (!value) {
        result.append(text.substr(0, begin + 1));
        text.remove_prefix(begin + 1);
        continue;
      }
      result.append(text.substr(0, begin)).append(value->text);
      text.remove_prefix(end + 1);
    }
  }

  Json filled(const Json& value) const {
    if (value.is_string()) return filled(value.get_ref<const std::string&>());
    if (!value.is_structured()) return value;
    auto result = value.is_array() ? Json::array() : Json::object();
    for (const auto& [key, member] : value.items()) {
      if (value.is_array()) {
        result.push_back(filled(member));
      } else {
        add_filled(result, filled_text(key), filled(member));
      }
    }
    return result;
  }

 private:
  /// Returns the value of "name", "name+1" or "name-1"; nullopt for any other text.
  std::optional<Filling> value_of(std::string_view expression) const {
    const auto sign = expression.find_first_of("+-");
    const auto name = expression.substr(0, sign);
    if (!is_name(name)) return std::nullopt;
    const auto found = std::ranges::find(values_, name, &Values::value_type::first);
    if (found == values_.end()) {
      std::vector<std::string> known;
      for (const auto& [other, value] : values_) known.push_back(other);
      throw InputError(ErrorCode::unknown_name, fmt::format("{{{}}}: the repeat has no {}; it has {}", expression, name,
                                                            fmt::join(known, ", ")));
    }
    if (sign == std::string_view::npos) return found->second;
    const auto offset = parsed_number<std::int64_t>(expression.substr(sign + 1));
    const auto& number = found->second.value;
    if (!offset || !number.is_number_integer()) {
      throw InputError(ErrorCode::invalid_value,
                       fmt::format("{{{}}}: a whole number can be added to an index alone", expression));
    }
    constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    const bool is_large = number.is_number_unsigned() && number.get<std::uint64_t>() > kLargest;
    const auto index = number.get<std::int64_t>();
    std::int64_t sum = 0;
    const bool overflows = expression[sign] == '-' ? __builtin_sub_overflow(index, *offset, &sum)
                                                   : __builtin_add_overflow(index, *offset, &sum);
    if (is_large || overflows) {
      throw InputError(ErrorCode::value_out_of_range, fmt::format("{{{}}}: the sum exceeds 64 bits", expression));
    }
    return Filling(Json(sum));
  }

  const Values& values_;
};

/// Returns the place of a value without the file name, such as "12:5: /connections/2".
std::string place_in_file(const Node& node, std::string_view file) {
  auto place = node.place();
  if (!place.starts_with(file)) return place;
  place.erase(0, file.size());
  return std::string(data::trimmed(std::string_view(place).substr(place.starts_with(':') ? 1 : 0)));
}

std::string shown(const Values& values) {
  std::vector<std::string> parts;
  for (const auto& [name, filling] : values) parts.push_back(fmt::format("{} = {}", name, filling.value.dump()));
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// True if a list in this value has an element with `repeat`.
bool repeats_inside(const Json& value) {
  return value.is_structured() && std::ranges::any_of(value, [&](const Json& one) {
           return (value.is_array() && one.is_object() && one.contains(kRepeat)) || repeats_inside(one);
         });
}

class Expansion {
 public:
  Expansion(const Groups& groups, Repeats& repeats, std::string file)
      : groups_(groups), repeats_(repeats), file_(std::move(file)) {}

  /// Returns the value at `pointer` after the expansion: list elements with `repeat` are replaced by their copies, and
  /// names in braces by `values`.
  Json of(const Node& node, const Json& content, const Values& values, const std::string& pointer) {
    if (!repeats_inside(content)) return values.empty() ? content : Filler(values).filled(content);
    return content.is_array() ? list(node, content, values, pointer) : object(node, content, values, pointer);
  }

  Json instances(const Node& section, const Json& content, const std::string& pointer) {
    auto result = Json::object();
    auto& members = static_cast<Json::object_t::Container&>(result.get_ref<Json::object_t&>());
    std::set<std::string> names;
    std::map<std::string_view, const Json*> entries;  // faster than an ordered object
    for (auto one = content.begin(); one != content.end(); ++one) entries.emplace(one.key(), &one.value());
    for (const auto& [key, node] : section.members()) {
      const auto in_file = place_in_file(node, file_);
      each_copy(node, *entries.at(key), {}, [&, &key = key, &node = node](const Json& entry, const Values& values) {
        auto name = values.empty() ? key : Filler(values).filled_text(key);
        if (!names.insert(name).second) {
          node.fail(
              ErrorCode::duplicate_name,
              fmt::format("two entries are named '{}'; put the index into the name, such as {}[{{i}}]", name, name));
        }
        const auto place = pointer + data::pointer_step(name);
        note_place(place, in_file, values);
        auto filled = of(node, entry, values, place);
        merge_parameters(node, filled, place + data::pointer_step(kParameters));
        members.emplace_back(std::move(name), std::move(filled));
      });
    }
    return result;
  }

 private:
  Json list(const Node& node, const Json& content, const Values& values, const std::string& pointer) {
    auto result = Json::array();
    std::size_t i = 0;
    for (const auto& element : node.elements()) {
      const auto in_file = place_in_file(element, file_);
      each_copy(element, content[i++], values, [&](Json entry, const Values& all) {
        name_member(entry, all, pointer);
        const auto place = pointer + data::pointer_step(std::to_string(result.size()));
        note_place(place, in_file, all);
        result.push_back(of(element, entry, all, place));
      });
    }
    return result;
  }

  Json object(const Node& node, const Json& content, const Values& values, const std::string& pointer) {
    auto result = Json::object();
    for (const auto& [key, member] : node.members()) {
      if (!content.contains(key)) continue;  // the key `repeat` of a copied entry
      const auto name = values.empty() ? key : Filler(values).filled_text(key);
      add_filled(result, name, of(member, content.at(key), values, pointer + data::pointer_step(name)));
    }
    return result;
  }

  /// Calls `put` for each copy. Passes the entry without `repeat`, and the values of the copy together with those in
  /// `outer`.
  template <typename Put>
  void each_copy(const Node& node, const Json& entry, const Values& outer, const Put& put) {
    const auto repeat = node.find(kRepeat);
    if (!repeat || !entry.is_object()) {
      node.attempt([&] { put(entry, outer); });
      return;
    }
    if (copies_ > kMostCopiesOfAll) return;  // the mistake was already reported
    repeat->attempt([&] {
      const auto copies = product(*repeat, {outer}, groups_.copies_of(*repeat));
      copies_ += copies.size();
      if (copies_ > kMostCopiesOfAll) {
        repeat->fail(ErrorCode::value_out_of_range,
                     fmt::format("there are more than {} copies of all entries together", kMostCopiesOfAll));
      }
      auto one = entry;
      one.erase(kRepeat);
      for (const auto& own : copies) {
        if (!node.attempt([&] { put(one, own); })) break;  // the other copies have the same mistake
        if (copies_ > kMostCopiesOfAll) break;             // a copy inside this one exceeded the limit
      }
    });
  }

  /// If `parameters` of an instance is a list of objects, merges them into one object. Must be called after elements
  /// with `repeat` were replaced by their copies.
  void merge_parameters(const Node& node, Json& instance, const std::string& pointer) {
    if (!instance.is_object() || !instance.contains(kParameters) || !instance.at(kParameters).is_array()) return;
    if (instance.at(kParameters).empty()) node.fail(ErrorCode::invalid_value, "the list of parameters is empty");
    auto merged = Json::object();
    std::size_t i = 0;
    for (const auto& part : instance.at(kParameters)) {
      const auto place = repeats_.places.find(pointer + data::pointer_step(std::to_string(i++)));
      if (!part.is_object()) node.fail(ErrorCode::wrong_type, "a list of parameters has objects only");
      for (const auto& [name, value] : part.items()) {
        if (merged.contains(name)) node.fail(ErrorCode::duplicate_name, fmt::format("'{}' is set twice", name));
        merged[name] = value;
        if (place != repeats_.places.end()) repeats_.places[pointer + data::pointer_step(name)] = place->second;
      }
    }
    instance[kParameters] = std::move(merged);
  }

  /// If `entry` is a member of a summary group and has only the key `variable`, adds a `name`: the indexes of its copy,
  /// such as "2" or "1,3". Conditions, which also occur in the summary, have more keys.
  static void name_member(Json& entry, const Values& values, std::string_view pointer) {
    if (!pointer.starts_with("/summary/") || !entry.is_object()) return;
    if (entry.size() != 1 || !entry.contains("variable")) return;
    std::vector<std::string> indexes;
    for (const auto& [name, value] : values) {
      if (value.is_index) indexes.push_back(value.text);
    }
    if (!indexes.empty()) entry["name"] = fmt::format("{}", fmt::join(indexes, ","));
  }

  /// Stores where the copy at `pointer` comes from: the line and column of its entry in the file (`place`), and the
  /// values of the copy.
  void note_place(const std::string& pointer, const std::string& place, const Values& values) {
    repeats_.places[pointer] = values.empty() ? place : fmt::format("{}, {}", place, shown(values));
  }

  const Groups& groups_;
  Repeats& repeats_;
  std::string file_;
  std::size_t copies_ = 0;
};

/// True if the node or an element of its list has `repeat`. If `inside` is false, does not search inside the elements,
/// because a list may be long.
bool is_repeated(const Node& node, bool inside = true) {
  if (node.is(data::Kind::list)) {
    return std::ranges::any_of(node.elements(),
                               [&](const Node& one) { return one.has(kRepeat) || (inside && is_repeated(one)); });
  }
  if (!node.is(data::Kind::object)) return false;
  return std::ranges::any_of(node.members(), [](const data::Member& one) { return is_repeated(one.value); });
}

/// True if an instance has `repeat`, or if its parameters are a list.
bool has_repeated_instances(const Node& root) {
  const auto instances = root.find(kInstances);
  return instances && instances->is(data::Kind::object) &&
         std::ranges::any_of(instances->members(), [](const data::Member& one) {
           const auto parameters = one.value.find(kParameters);
           return one.value.has(kRepeat) || (parameters && parameters->is(data::Kind::list));
         });
}

}  // namespace

void read_groups(const Node& /*node*/, SystemDescription& /*system*/) {}

bool has_repeats(const Node& root) {
  if (!root.is(data::Kind::object)) return false;
  if (root.has(kGroups) || has_repeated_instances(root)) return true;
  return std::ranges::any_of(root.members(), [](const data::Member& one) {
    return one.key != kInstances && is_repeated(one.value, one.key != "connections");
  });
}

void expand_repeats(const Node& root, Json& config, const std::string& file, Repeats& repeats) {
  if (repeats.places.empty()) {
    for (const auto& [key, member] : root.members()) {
      repeats.places[data::pointer_step(key)] = place_in_file(member, file);
    }
  }
  Groups groups(repeats);
  if (const auto node = root.find(kGroups)) groups.read(*node);
  config.erase(kGroups);
  Expansion expansion(groups, repeats, file);
  for (const auto& [key, section] : root.members()) {
    const auto pointer = data::pointer_step(key);
    if (key == kGroups || !config.contains(key)) continue;
    if (key != kInstances) {
      config[key] = expansion.of(section, config.at(key), {}, pointer);
    } else if (has_repeated_instances(root)) {
      config[key] = expansion.instances(section, config.at(key), pointer);
    }
  }
}

}  // namespace mebots::master::config
