// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elf/elf.hpp"
#include "hart/observer.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::observe {

/// Names of the places where time is spent, as small numbers: functions of the program and states of the core.
class Functions {
 public:
  explicit Functions(const Elf& program);

  /// The function that a call into `address` enters. Without a symbol there: one named by the address.
  std::uint32_t entered(std::uint32_t address);
  /// The function that the code at `address` belongs to when `current` has run on, or jumped, to it. Code without a
  /// symbol belongs to whom it was reached from.
  std::uint32_t reached(std::uint32_t address, std::uint32_t current);
  /// A place that is no code, such as "asleep".
  std::uint32_t named(std::string_view name);

  /// Whether `address` is certainly inside `function`; cheap.
  bool inside(std::uint32_t function, std::uint32_t address) const { return code(function).holds(address); }
  /// What is its own for sure.
  QuietCode code(std::uint32_t function) const { return {places_[function].begin, places_[function].size}; }
  const std::string& name(std::uint32_t function) const { return places_[function].name; }
  std::uint32_t count() const { return static_cast<std::uint32_t>(places_.size()); }

 private:
  struct Place {
    std::string name;
    std::uint32_t begin = 0;
    std::uint32_t size = 0;  // bytes of code that are its own for sure
  };
  std::uint32_t of_symbol(const ElfSymbol& symbol);

  const Elf& program_;
  std::vector<Place> places_;
  std::map<std::string, std::uint32_t, std::less<>> by_name_;
  std::map<std::uint32_t, std::uint32_t> by_address_;  // of functions and of calls into nothing known
};

}  // namespace mebots::soc::observe
