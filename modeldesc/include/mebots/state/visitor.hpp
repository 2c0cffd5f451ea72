// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

/// Each class declares its state once, in a member function visit(), which passes every value with its name to the
/// visitor:
///
///     void Cell::visit(state::Visitor& v) {
///       v("soc", soc_);
///       v("branch_v", branch_v_);
///       if (v.restores()) find_curve();  // what follows from the values above
///     }
///
/// Saving and restoring (mebots/state/save.hpp), the layout hash (mebots/state/layout.hpp) and the comparison of two
/// states (mebots/state/difference.hpp) all call this function. The function must follow two rules. It visits the same
/// names in every call: they depend only on the construction of the object, not on values that change. It changes the
/// object only if restores() is true. A list or an optional is visited as a whole.
namespace mebots::state {

class Visitor;

template <typename T>
concept Visited = requires(T& value, Visitor& visitor) {
  value.visit(visitor);
};

/// Numbers, Booleans and enumerations.
template <typename T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

enum class Type : std::uint8_t {
  boolean,
  character,
  int8,
  int16,
  int32,
  int64,
  uint8,
  uint16,
  uint32,
  uint64,
  float32,
  float64
};

template <Plain T>
constexpr Type type_of() {
  if constexpr (std::is_enum_v<T>) {
    return type_of<std::underlying_type_t<T>>();
  } else if constexpr (std::is_same_v<T, bool>) {
    return Type::boolean;
  } else if constexpr (std::is_same_v<T, char>) {
    return Type::character;
  } else if constexpr (std::is_floating_point_v<T>) {
    static_assert(sizeof(T) == 4 || sizeof(T) == 8, "a long double has bytes without a value");
    return sizeof(T) == 4 ? Type::float32 : Type::float64;
  } else {
    constexpr auto kFirst = static_cast<std::uint8_t>(std::is_signed_v<T> ? Type::int8 : Type::uint8);
    return static_cast<Type>(kFirst + (sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : sizeof(T) == 4 ? 2 : 3));
  }
}

/// A fixed number of plain values in contiguous memory.
struct Values {
  Type type;
  std::size_t size;  ///< size of one value in bytes
  std::size_t count;
  void* data;

  std::size_t bytes() const { return size * count; }
};

/// A variable number of plain values in contiguous memory: a vector or a text.
class List {
 public:
  virtual ~List() = default;
  virtual Values values() = 0;
  virtual void resize(std::size_t count) = 0;
};

/// Base class of all visitors. A visitor reads or restores the state of objects. Not thread-safe.
class Visitor {
 public:
  virtual ~Visitor() = default;
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  bool restores() const { return purpose_ == Purpose::restore; }

  /// Visits a plain value, an object with visit(), or an array, vector, text, optional or variant of these. `name` is
  /// the member's name without the underscore, and need not be valid after the call.
  template <typename T>
  void operator()(std::string_view name, T& value) {
    if constexpr (Visited<T>) {
      const Inside inside(*this, name);
      value.visit(*this);
    } else if constexpr (Plain<T>) {
      fixed(name, {type_of<T>(), sizeof(T), 1, &value});
    } else {
      parts(name, value);
    }
  }

  /// Visits plain values. Their number must not change after the construction of the object.
  template <typename T, std::size_t Extent>
  void operator()(std::string_view name, std::span<T, Extent> values) {
    if constexpr (Plain<T>) {
      fixed(name, {type_of<T>(), sizeof(T), values.size(), values.data()});
    } else {
      const Inside inside(*this, name);
      for (std::size_t i = 0; i < values.size(); ++i) (*this)(index(i), values[i]);
    }
  }

 protected:
  enum class Purpose : std::uint8_t { save, restore, layout, list };
  explicit Visitor(Purpose purpose) : purpose_(purpose) {}

  virtual void fixed(std::string_view name, const Values& values) = 0;
  virtual void changing(std::string_view name, List& list) = 0;
  /// Visits the size of a list of objects. `present` is the current size. The caller must resize the list to the
  /// returned size.
  virtual std::size_t count(std::string_view name, std::size_t present) = 0;
  /// Opens a scope: all values up to the matching leave() are parts of `name`. Called only if wants_names() returns
  /// true.
  virtual void enter(std::string_view /*name*/) {}
  virtual void leave() {}

 private:
  class Inside {
   public:
    Inside(Visitor& visitor, std::string_view name) : visitor_(visitor.wants_names() ? &visitor : nullptr) {
      if (visitor_ != nullptr) visitor_->enter(name);
    }
    ~Inside() {
      if (visitor_ != nullptr) visitor_->leave();
    }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;

   private:
    Visitor* visitor_;
  };

  template <typename Container>
  class ListOf final : public List {
   public:
    explicit ListOf(Container& values) : values_(values) {}
    Values values() override {
      using T = typename Container::value_type;
      return {type_of<T>(), sizeof(T), values_.size(), values_.data()};
    }
    void resize(std::size_t count) override { values_.resize(count); }

   private:
    Container& values_;
  };

  bool wants_names() const { return purpose_ == Purpose::layout || purpose_ == Purpose::list; }

  std::string index(std::size_t i) const {
    return purpose_ == Purpose::list ? "[" + std::to_string(i) + "]" : std::string();
  }

  template <typename T, std::size_t Count>
  void parts(std::string_view name, std::array<T, Count>& values) {
    (*this)(name, std::span(values));
  }

  template <typename T, std::size_t Count>
  void parts(std::string_view name, T (&values)[Count]) {
    (*this)(name, std::span(values));
  }

  void parts(std::string_view name, std::string& text) {
    ListOf<std::string> list(text);
    changing(name, list);
  }

  void parts(std::string_view name, std::filesystem::path& path) {
    std::string text = path.string();
    (*this)(name, text);
    if (restores()) path = text;
  }

  template <typename T>
  void parts(std::string_view name, std::vector<T>& values) {
    static_assert(!std::is_same_v<T, bool>, "a vector of bool has no values to point at: use std::uint8_t");
    if constexpr (Plain<T>) {
      ListOf<std::vector<T>> list(values);
      changing(name, list);
    } else {
      const std::size_t wanted = count(name, values.size());
      if (restores()) values.resize(wanted);
      if (show_one_as_pattern<T>(name)) return;
      const Inside inside(*this, name);
      for (std::size_t i = 0; i < values.size(); ++i) (*this)(index(i), values[i]);
    }
  }

  template <typename T>
  void parts(std::string_view name, std::optional<T>& value) {
    const std::size_t wanted = count(name, value.has_value() ? 1 : 0);
    if (restores()) {
      if (wanted == 0)
        value.reset();
      else if (!value)
        value.emplace();
    }
    if (show_one_as_pattern<T>(name)) return;
    if (value) (*this)(name, *value);
  }

  template <typename... Types>
  void parts(std::string_view name, std::variant<Types...>& value) {
    auto kind = static_cast<std::uint8_t>(value.index());
    (*this)(std::string(name) + ".kind", kind);
    if (restores()) {
      if (kind >= sizeof...(Types))
        throw Error(ErrorCode::state_damaged, "a saved state is damaged: a value is of no known type");
      std::size_t index = 0;
      ((index++ == kind ? static_cast<void>(value.template emplace<Types>()) : static_cast<void>(0)), ...);
    }
    if (purpose_ == Purpose::layout) {
      (show_one_as_pattern<Types>(name), ...);
      return;
    }
    std::visit([&](auto& held) { (*this)(name, held); }, value);
  }

  /// If this visitor computes a layout, visits one default-constructed element and returns true. The layout then
  /// includes the element type also for an empty list.
  template <typename T>
  bool show_one_as_pattern(std::string_view name) {
    if (purpose_ != Purpose::layout) return false;
    T pattern{};
    (*this)(name, pattern);
    return true;
  }

  Purpose purpose_;
};

}  // namespace mebots::state
