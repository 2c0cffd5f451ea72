// SPDX-License-Identifier: Apache-2.0
// Replaces entries with `repeat` by their copies, before the sections are read.
#include "io/config/load_system.hpp"
#include "io/config/sections.hpp"

#include "base/input_text.hpp"
#include "mebots/data/csv.hpp"
#include "mebots/data/mistakes.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"

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

constexpr std::int64_t kMostCopies = 100'000;

/// The replacement of a name in braces: a value, or a part of a text.
struct Filling {
  // NOLINTNEXTLINE(google-explicit-constructor): a value is written as it is
  Filling(Json v) : value(std::move(v)), text(value.is_string() ? value.get<std::string>() : value.dump()) {}
  Filling(Json v, std::string t) : value(std::move(v)), text(std::move(t)) {}
  Json value;
  std::string text;
};

/// The names in braces, for one copy.
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

Json json_of(const Node& node) {
  const auto value = written_value(node);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return *whole;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (node.is(data::Kind::whole_number)) return node.natural_number();
  return node.text();
}

/// Returns true for 007, which is a name: JSON has no such number.
bool has_leading_zero(std::string_view cell) {
  if (cell.starts_with('-')) cell.remove_prefix(1);
  return cell.size() > 1 && cell[0] == '0' && std::isdigit(static_cast<unsigned char>(cell[1])) != 0;
}

/// A number, true and false as such, everything else as text.
Json json_of(std::string_view cell) {
  if (has_leading_zero(cell)) return std::string(cell);
  if (const auto whole = data::csv_number<std::int64_t>(cell)) return *whole;
  if (const auto whole = data::csv_number<std::uint64_t>(cell)) return *whole;
  if (const auto number = data::csv_number<double>(cell); number && std::isfinite(*number)) return *number;
  if (cell == "true" || cell == "false") return cell == "true";
  return std::string(cell);
}

/// [first, last]
std::vector<Values> numbers(const Node& node, const std::string& index) {
  const auto ends = node.elements();
  if (ends.size() != 2) {
    node.fail(ErrorCode::invalid_value, "write [first, last], the name of a CSV file, or lists by their names");
  }
  const auto first = ends[0].whole_number(-kMostCopies, kMostCopies);
  const auto last = ends[1].whole_number(first, first + kMostCopies - 1);
  std::vector<Values> rows;
  for (auto number = first; number <= last; ++number) rows.push_back({{index, Json(number)}});
  return rows;
}

/// {"mass": [0.03, 0.031], "x": [0, 1]}
std::vector<Values> lists(const Node& node, const std::string& index) {
  std::vector<Values> rows;
  bool is_first = true;
  for (const auto& [name, list] : node.members()) {
    check_name(list, name);
    const auto elements = list.elements();
    if (is_first) {
      for (std::size_t row = 0; row < elements.size(); ++row) rows.push_back({{index, Json(row + 1)}});
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

/// "drones.csv"
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
  for (const auto& name : csv.header()) check_name(node, name);
  std::vector<Values> rows;
  while (csv.next()) {
    Values row = {{index, Json(rows.size() + 1)}};
    for (std::size_t i = 0; i < csv.header().size(); ++i) {
      const auto cell = data::trimmed(csv.cell(i));
      row.emplace_back(csv.header()[i], Filling(json_of(cell), std::string(cell)));
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty()) node.fail(ErrorCode::invalid_value, fmt::format("{} has no row", file.string()));
  return rows;
}

/// Returns the values of every copy: all combinations of the indexes, the last one fastest.
std::vector<Values> read_copies(const Node& node, Repeats& repeats) {
  std::vector<Values> copies = {{}};
  std::set<std::string> names;
  for (const auto& [index, range] : node.members()) {
    check_name(range, index);
    const auto rows = range.is(data::Kind::list)     ? numbers(range, index)
                      : range.is(data::Kind::object) ? lists(range, index)
                                                     : table(range, index, repeats);
    for (const auto& [name, value] : rows.front()) {
      if (!names.insert(name).second)
        range.fail(ErrorCode::invalid_value, fmt::format("there are two values {}", name));
    }
    if (copies.size() * rows.size() > static_cast<std::size_t>(kMostCopies)) {
      range.fail(ErrorCode::value_out_of_range, fmt::format("there are more than {} copies", kMostCopies));
    }
    std::vector<Values> product;
    for (const auto& copy : copies) {
      for (const auto& row : rows) {
        product.push_back(copy);
        product.back().insert(product.back().end(), row.begin(), row.end());
      }
    }
    copies = std::move(product);
  }
  if (copies.front().empty()) node.fail(ErrorCode::invalid_value, "name an index, such as {\"i\": [1, 16]}");
  return copies;
}

/// Replaces names in braces. Throws InputError for an unknown one.
class Filler {
 public:
  explicit Filler(const Values& values) : values_(values) {}

  /// If a text consists only of a name in braces, it becomes the value itself, for example a number.
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
        auto name = filled_text(key);
        if (result.contains(name))
          throw InputError(ErrorCode::duplicate_name, fmt::format("two keys of one copy become '{}'", name));
        result[std::move(name)] = filled(member);
      }
    }
    return result;
  }

 private:
  /// Returns the value of "name", "name+1" or "name-1"; empty if the text is no such expression.
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
    const auto offset = data::csv_number<std::int64_t>(expression.substr(sign + 1));
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

/// Returns "12:5: /connections/2", the place of a value without the file's name.
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

/// The members of an object or the elements of a list, with their copies.
class Expansion {
 public:
  Expansion(const Node& section, Repeats& repeats, std::string file)
      : section_(section), repeats_(repeats), file_(std::move(file)) {}

  Json of(const Json& content) {
    is_list_ = content.is_array();
    result_ = is_list_ ? Json::array() : Json::object();
    if (is_list_) {
      std::size_t i = 0;
      for (const auto& element : section_.elements()) add(element, "", content[i++]);
    } else {
      std::map<std::string_view, const Json*> members;  // an ordered object searches linearly
      for (auto one = content.begin(); one != content.end(); ++one) members.emplace(one.key(), &one.value());
      for (const auto& [key, member] : section_.members()) add(member, key, *members.at(key));
    }
    return std::move(result_);
  }

 private:
  void add(const Node& node, const std::string& key, const Json& entry) {
    const auto place = place_in_file(node, file_);
    const auto repeat = node.find(kRepeat);
    if (!repeat) {
      put(node, key, entry, place);
      return;
    }
    repeat->attempt([&] {
      auto one = entry;
      one.erase(kRepeat);
      for (const auto& values : read_copies(*repeat, repeats_)) {
        const bool is_filled = node.attempt([&] {
          const Filler filler(values);
          put(node, filler.filled_text(key), filler.filled(one), fmt::format("{}, {}", place, shown(values)));
        });
        if (!is_filled) break;  // the other copies have the same mistake
      }
    });
  }

  void put(const Node& node, const std::string& key, Json entry, const std::string& place) {
    const auto step = is_list_ ? std::to_string(result_.size()) : key;
    if (!is_list_ && !names_.insert(key).second) {
      node.fail(ErrorCode::duplicate_name,
                fmt::format("two entries are named '{}'; put the index into the name, such as {}[{{i}}]", key, key));
    }
    repeats_.places[section_.pointer() + data::pointer_step(step)] = place;
    if (is_list_) {
      result_.push_back(std::move(entry));
    } else {
      auto& members = static_cast<Json::object_t::Container&>(result_.get_ref<Json::object_t&>());
      members.emplace_back(key, std::move(entry));
    }
  }

  const Node& section_;
  Repeats& repeats_;
  std::string file_;
  Json result_;
  std::set<std::string> names_;
  bool is_list_ = false;
};

template <typename Visit>
void each_section(const Node& root, const Visit& visit) {
  if (!root.is(data::Kind::object)) return;
  for (const auto* key : {"instances", "connections", "stop_when", "outcomes"}) {
    const auto section = root.find(key);
    const bool fits =
        section && section->is(key == std::string_view("instances") ? data::Kind::object : data::Kind::list);
    if (fits) visit(key, *section);
  }
}

bool has_repeats_in(const Node& section) {
  if (section.is(data::Kind::list)) {
    return std::ranges::any_of(section.elements(), [](const Node& one) { return one.has(kRepeat); });
  }
  return std::ranges::any_of(section.members(), [](const data::Member& one) { return one.value.has(kRepeat); });
}

}  // namespace

bool has_repeats(const Node& root) {
  bool found = false;
  each_section(root, [&](const char*, const Node& section) { found = found || has_repeats_in(section); });
  return found;
}

void expand_repeats(const Node& root, Json& config, const std::string& file, Repeats& repeats) {
  if (repeats.places.empty()) {
    for (const auto& [key, member] : root.members()) {
      repeats.places[data::pointer_step(key)] = place_in_file(member, file);
    }
  }
  each_section(root, [&](const char* key, const Node& section) {
    if (has_repeats_in(section)) config[key] = Expansion(section, repeats, file).of(config.at(key));
  });
}

}  // namespace mebots::master::config
