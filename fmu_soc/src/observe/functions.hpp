// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elf/elf.hpp"
#include "hart/observer.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::observe {

/// Numbers and names the places to which a profile assigns costs: functions of the program, and states of the core.
class Functions final : public FlowMap {
 public:
  explicit Functions(const Elf& program);

  /// Returns true if a step from the instruction at `pc` to that at `next` may enter another function. The instruction
  /// at `pc` must be neither a call nor a return.
  bool may_leave_function(std::uint32_t pc, std::uint32_t next) const override;

  /// Returns the function that a call of `address` enters. If no symbol contains the address, the address is used as
  /// the name.
  std::uint32_t entered(std::uint32_t address);
  /// Returns the function at `address`, which is reached from an instruction of the function `current` without a call.
  /// If no symbol contains the address, returns `current`.
  std::uint32_t reached(std::uint32_t address, std::uint32_t current);
  /// Returns the number of a place that is not code, such as "asleep".
  std::uint32_t named(std::string_view name);

  /// Returns true if `address` is certainly inside `function`. This fast check may return false for an address inside.
  bool inside(std::uint32_t function, std::uint32_t address) const { return code(function).holds(address); }
  /// Returns a range of code that certainly belongs to the function.
  QuietCode code(std::uint32_t function) const { return {places_[function].begin, places_[function].size}; }
  const std::string& name(std::uint32_t function) const { return places_[function].name; }
  std::uint32_t count() const { return static_cast<std::uint32_t>(places_.size()); }

 private:
  struct Place {
    std::string name;
    std::uint32_t begin = 0;
    std::uint32_t size = 0;  // size of the code that certainly belongs to the function [bytes]
  };
  struct Recent {
    std::uint32_t address = 1;  // 1 marks an empty entry, because no pc is odd
    std::uint32_t place = 0;
  };
  std::uint32_t of_symbol(const ElfSymbol& symbol);
  std::uint32_t find_entered(std::uint32_t address);

  const Elf& program_;
  std::vector<Place> places_;
  std::map<std::string, std::uint32_t, std::less<>> by_name_;
  /// Maps an address to a function; also contains targets of calls without a symbol.
  std::map<std::uint32_t, std::uint32_t> by_address_;
  std::array<Recent, 256> recent_{};  // cache of the functions that were called last
};

}  // namespace mebots::soc::observe
