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

/// Reads the members of an object one after the other, each into its variable:
///
///     Object object(node);
///     object.read("name", gate.name, &Node::text);
///     object.read_if("yaw", gate.yaw_rad, number());
///     object.finish();
///
/// A member that is missing or wrong is noted and leaves its variable alone; reading goes on with the next. The keys
/// that were asked for are the keys that there are, so none is written twice.
class Object {
 public:
  /// Throws Mistakes when the node is not an object.
  explicit Object(const Node& node);

  /// `reader` makes the value from the member's node. True when it did so without a mistake.
  template <typename T, typename Reader>
  bool read(std::string_view key, T& into, const Reader& reader) {
    known_.emplace_back(key);
    const auto member = node_.find(key);
    if (!member) complain_missing(key);
    return member && take(*member, into, reader);
  }
  /// The same for a key that may be absent, which leaves the variable alone; then false.
  template <typename T, typename Reader>
  bool read_if(std::string_view key, T& into, const Reader& reader) {
    known_.emplace_back(key);
    const auto member = node_.find(key);
    return member && take(*member, into, reader);
  }
  /// The same for a reader that puts what it reads into several places, and returns nothing.
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
  /// Keys that may stand here and are read elsewhere, or by people only.
  void allow(std::initializer_list<std::string_view> keys) { known_.insert(known_.end(), keys.begin(), keys.end()); }
  /// A text for people, or for editors, that may be absent.
  void comment(std::string_view key);

  /// Notes the keys that nobody asked for: most often typing errors, which are answered by the nearest key.
  void finish() const;

  /// No mistake came since this Object began, here or in what is inside: what members say of each other can be checked.
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

/// Readers of one value, for Object::read.
inline auto number(const Limits& limits = {}) {
  return [limits](const Node& node) { return node.number(limits); };
}
inline auto whole_number(std::int64_t least, std::int64_t most) {
  return [=](const Node& node) { return node.whole_number(least, most); };
}
/// Numbers of a list that is not empty.
std::vector<double> read_numbers(const Node& node, const Limits& limits);
inline auto numbers(const Limits& limits = {}) {
  return [limits](const Node& node) { return read_numbers(node, limits); };
}
/// The same with each greater than the one before.
std::vector<double> read_rising_numbers(const Node& node, const Limits& limits);
inline auto rising_numbers(const Limits& limits = {}) {
  return [limits](const Node& node) { return read_rising_numbers(node, limits); };
}
/// The value of {"value", "unit", "source"}; checks the unit. "interval": [low, high] and "fitted_on" are optional.
double read_quantity(const Node& node, std::string_view unit, const Limits& limits);
inline auto quantity(std::string_view unit, const Limits& limits = {}) {
  return [=](const Node& node) { return read_quantity(node, unit, limits); };
}
/// Members `unit`, which must be the one asked for, and `source`, which must not be empty.
void read_unit(Object& object, std::string_view unit);
void read_source(Object& object);

/// What a word stands for. An unknown one is answered by the nearest.
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

/// What `reader` makes of each element of a list; elements that it refuses are noted and left out.
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
