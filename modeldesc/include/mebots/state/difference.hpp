// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/save.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace mebots::state {

/// A saved state, and the name and offset of each value in it.
struct Listing {
  struct Variable {
    std::string path;  ///< names joined by dots, "cluster.core[3].hart.x"
    Type type;
    std::size_t size;   ///< size of one value in bytes
    std::size_t count;  ///< number of values
    std::size_t at;     ///< offset in the saved state in bytes
    bool is_one;        ///< true for a single value, false for an array or list
  };
  std::vector<Variable> variables;
  std::vector<std::byte> bytes;
};

class Lister final : public Saver {
 public:
  Lister() : Saver(writer_, Purpose::list) {}

  Listing take() { return {std::move(variables_), writer_.take()}; }

 private:
  void fixed(std::string_view name, const Values& values) override {
    note(name, values, writer_.bytes().size(), values.count == 1);
    Saver::fixed(name, values);
  }
  void changing(std::string_view name, List& list) override {
    const Values values = list.values();
    Saver::changing(name, list);
    note(name, values, writer_.bytes().size() - values.bytes(), false);
  }
  std::size_t count(std::string_view name, std::size_t present) override {
    variables_.push_back(
        {path_of(name) + ".size", Type::uint64, sizeof(std::uint64_t), 1, writer_.bytes().size(), true});
    return Saver::count(name, present);
  }
  void enter(std::string_view name) override {
    lengths_.push_back(path_.size());
    path_ = path_of(name);
  }
  void leave() override {
    path_.resize(lengths_.back());
    lengths_.pop_back();
  }

  std::string path_of(std::string_view name) const {
    std::string path = path_;
    if (!path.empty() && !name.empty() && name.front() != '[') path += '.';
    return path.append(name);
  }
  void note(std::string_view name, const Values& values, std::size_t at, bool is_one) {
    variables_.push_back({path_of(name), values.type, values.size, values.count, at, is_one});
  }

  Writer writer_;
  std::vector<Listing::Variable> variables_;
  std::string path_;
  std::vector<std::size_t> lengths_;  // length of the path before each enter()
};

template <Visited T>
Listing list(const T& object) {
  Lister lister;
  const_cast<T&>(object).visit(lister);
  return lister.take();
}

/// The first variable in which two states differ, and its value in each state.
struct Difference {
  std::string path;
  std::string first;
  std::string second;

  bool operator==(const Difference&) const = default;
  friend std::ostream& operator<<(std::ostream& stream, const Difference& difference) {
    return stream << difference.text();
  }
  std::string text() const { return path + " is " + first + " in one and " + second + " in the other"; }
};

namespace detail {

template <typename T>
T value_at(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

template <typename T>
std::string number_text(const std::byte* at) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value_at<T>(at)).ptr;
  return {text.data(), end};
}

inline std::string value_text(Type type, const std::byte* at) {
  switch (type) {
    case Type::boolean:
      return value_at<std::uint8_t>(at) != 0 ? "true" : "false";
    case Type::character:
      return {'\'', value_at<char>(at), '\''};
    case Type::int8:
      return number_text<std::int8_t>(at);
    case Type::int16:
      return number_text<std::int16_t>(at);
    case Type::int32:
      return number_text<std::int32_t>(at);
    case Type::int64:
      return number_text<std::int64_t>(at);
    case Type::uint8:
      return number_text<std::uint8_t>(at);
    case Type::uint16:
      return number_text<std::uint16_t>(at);
    case Type::uint32:
      return number_text<std::uint32_t>(at);
    case Type::uint64:
      return number_text<std::uint64_t>(at);
    case Type::float32:
      return number_text<float>(at);
    case Type::float64:
      return number_text<double>(at);
  }
  return {};
}

}  // namespace detail

/// Returns the first variable in which two listings differ; empty if both contain the same variables with the same
/// bits.
inline std::optional<Difference> first_difference(const Listing& first, const Listing& second) {
  const std::size_t common = std::min(first.variables.size(), second.variables.size());
  for (std::size_t v = 0; v < common; ++v) {
    const auto& one = first.variables[v];
    const auto& other = second.variables[v];
    if (one.path != other.path || one.type != other.type)
      return Difference{one.path, "the next variable", other.path};  // the lists differ in length, or the builds differ
    const auto* a = first.bytes.data() + one.at;
    const auto* b = second.bytes.data() + other.at;
    for (std::size_t i = 0; i < std::min(one.count, other.count); ++i, a += one.size, b += one.size) {
      if (std::memcmp(a, b, one.size) == 0) continue;
      return Difference{one.is_one ? one.path : one.path + "[" + std::to_string(i) + "]",
                        detail::value_text(one.type, a), detail::value_text(one.type, b)};
    }
    if (one.count != other.count)
      return Difference{one.path + ".size", std::to_string(one.count), std::to_string(other.count)};
  }
  if (first.variables.size() == second.variables.size()) return std::nullopt;
  const auto& longer = first.variables.size() > common ? first : second;
  const auto& path = longer.variables[common].path;
  return first.variables.size() > common ? Difference{path, "there", "missing"} : Difference{path, "missing", "there"};
}

/// Returns the first difference between the states of two objects; empty if the states are equal.
template <Visited T>
std::optional<Difference> first_difference(const T& first, const T& second) {
  return first_difference(list(first), list(second));
}

/// Returns the first difference between two saved states of one object. Restores both states into `object`, which is
/// then in the second state.
template <Visited T>
std::optional<Difference> first_difference(T& object, std::span<const std::byte> first,
                                           std::span<const std::byte> second) {
  restore(object, first);
  const Listing listing = list(object);
  restore(object, second);
  return first_difference(listing, list(object));
}

}  // namespace mebots::state
