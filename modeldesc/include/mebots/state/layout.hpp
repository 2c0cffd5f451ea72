// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace mebots::state {

/// Computes a hash (64-bit FNV-1a) of the names, types, sizes and order of all visited values. The values themselves do
/// not affect the hash. A build can restore states of another build if both have the same hash.
class Layout final : public Visitor {
 public:
  Layout() : Visitor(Purpose::layout) {}

  std::uint64_t fingerprint() const { return hash_; }

 private:
  enum class Mark : std::uint8_t { fixed, changing, objects, enter, leave };

  void fixed(std::string_view name, const Values& values) override {
    add(Mark::fixed);
    add(name);
    add(values.type);
    add(std::uint64_t{values.count});
  }
  void changing(std::string_view name, List& list) override {
    add(Mark::changing);
    add(name);
    add(list.values().type);
  }
  std::size_t count(std::string_view name, std::size_t /*present*/) override {
    add(Mark::objects);
    add(name);
    return 0;
  }
  void enter(std::string_view name) override {
    add(Mark::enter);
    add(name);
  }
  void leave() override { add(Mark::leave); }

  template <Plain T>
  void add(T value) {
    for (auto rest = static_cast<std::uint64_t>(value), i = std::uint64_t{0}; i < sizeof(T); ++i, rest >>= 8)
      hash_ = (hash_ ^ (rest & 0xFF)) * 0x100000001B3U;
  }
  void add(std::string_view text) {
    add(std::uint64_t{text.size()});
    for (const char letter : text) add(static_cast<std::uint8_t>(letter));
  }

  std::uint64_t hash_ = 0xCBF29CE484222325U;
};

template <Visited T>
std::uint64_t layout_of(const T& object) {
  Layout layout;
  const_cast<T&>(object).visit(layout);
  return layout.fingerprint();
}

}  // namespace mebots::state
