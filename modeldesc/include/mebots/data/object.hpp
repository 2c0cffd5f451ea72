// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"

#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace mebots::data {

/// Reads the members of an object into variables, one after the other:
///
///     Object object(node);
///     object.read("name", gate.name, &Node::text);
///     object.read_if("yaw", gate.yaw_rad, number());
///     object.finish();
///
/// If a member is missing or wrong, adds a mistake and leaves its variable unchanged. finish() reports every key that
/// was not read.
class Object {
 public:
  /// Throws Mistakes if the node is not an object.
  explicit Object(const Node& node);

  /// Sets `into` to reader(member). Returns false if the member is missing or wrong.
  template <typename T, typename Reader>
  bool read(std::string_view key, T& into, const Reader& reader) {
    known_.emplace_back(key);
    const auto member = node_.find(key);
    if (!member) complain_missing(key);
    return member && take(*member, into, reader);
  }
  /// Works as read() for an optional key. If the key is absent, leaves the variable unchanged and returns false.
  template <typename T, typename Reader>
  bool read_if(std::string_view key, T& into, const Reader& reader) {
    known_.emplace_back(key);
    const auto member = node_.find(key);
    return member && take(*member, into, reader);
  }
  /// Works as read(), but ignores the result of `reader`. `reader` stores the values itself.
  template <typename Reader>
  bool visit(std::string_view key, const Reader& reader) {
    bool done = false;
    return read(key, done, [&](const Node& member) {
      reader(member);
      return true;
    });
  }
  template <typename Reader>
  bool visit_if(std::string_view key, const Reader& reader) {
    return node_.has(key) ? visit(key, reader) : (known_.emplace_back(key), false);
  }
  /// Permits keys that this object does not read, such as keys for other readers or comments.
  void allow(std::initializer_list<std::string_view> keys) { known_.insert(known_.end(), keys.begin(), keys.end()); }
  /// Permits an optional key whose value is a text and has no effect.
  void comment(std::string_view key);

  /// Reports each key that was neither read nor permitted by allow() or comment(). Suggests the nearest known key.
  void finish() const;

  /// True if no mistake was added to the document since this Object was constructed. Then all members that were read
  /// are valid.
  bool sound() const { return node_.noted() == noted_before_; }
  bool has(std::string_view key) const { return node_.has(key); }
  const Node& node() const { return node_; }

 private:
  template <typename T, typename Reader>
  static bool take(const Node& member, T& into, const Reader& reader) {
    const auto noted_before = member.noted();
    member.attempt([&] {
      auto value = std::invoke(reader, member);
      if (member.noted() == noted_before) into = std::move(value);
    });
    return member.noted() == noted_before;
  }
  void complain_missing(std::string_view key) const;

  Node node_;
  std::size_t noted_before_;
  std::vector<std::string> known_;
};

/// These functions return readers for the argument `reader` of Object::read().
inline auto number(const Limits& limits = {}) {
  return [limits](const Node& node) { return node.number(limits); };
}
inline auto whole_number(std::int64_t least, std::int64_t most) {
  return [=](const Node& node) { return node.whole_number(least, most); };
}
/// Reads a list of numbers. Throws Mistakes if the list is empty.
std::vector<double> read_numbers(const Node& node, const Limits& limits);
inline auto numbers(const Limits& limits = {}) {
  return [limits](const Node& node) { return read_numbers(node, limits); };
}
/// Reads numbers as read_numbers() does. Adds a mistake for each number that is not greater than its predecessor.
std::vector<double> read_rising_numbers(const Node& node, const Limits& limits);
inline auto rising_numbers(const Limits& limits = {}) {
  return [limits](const Node& node) { return read_rising_numbers(node, limits); };
}
/// Reads an object with the keys "value", "unit" and "source". Checks the unit and returns the value. The keys
/// "interval" ([low, high]) and "fitted_on" are optional.
double read_quantity(const Node& node, std::string_view unit, const Limits& limits);
inline auto quantity(std::string_view unit, const Limits& limits = {}) {
  return [=](const Node& node) { return read_quantity(node, unit, limits); };
}
/// Read the members `unit` and `source`. `unit` must equal the argument `unit`, and `source` must not be empty.
void read_unit(Object& object, std::string_view unit);
void read_source(Object& object);

/// Returns a reader that maps a word of the file to the value in `words`. For an unknown word, the error message
/// suggests the most similar known word.
template <typename T>
auto word_of(std::vector<std::pair<std::string, T>> words) {
  return [words = std::move(words)](const Node& node) {
    const std::string found = node.text();
    std::vector<std::string> known;
    for (const auto& [word, meaning] : words) {
      if (word == found) return meaning;
      known.push_back(word);
    }
    node.fail_unknown("the word", found, known);
  };
}

/// Returns a reader of lists, which applies `reader` to each element and returns the results. Reports and omits
/// elements that `reader` rejects.
template <typename Reader>
auto list_of(Reader reader) {
  return [reader = std::move(reader)](const Node& node) {
    std::vector<std::decay_t<std::invoke_result_t<const Reader&, const Node&>>> found;
    for (const Node& element : node.elements()) {
      element.attempt([&] { found.push_back(std::invoke(reader, element)); });
    }
    return found;
  };
}

}  // namespace mebots::data
