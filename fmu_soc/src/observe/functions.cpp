// SPDX-License-Identifier: Apache-2.0
#include "observe/functions.hpp"

#include <fmt/core.h>

namespace mebots::soc::observe {

Functions::Functions(const Elf& program) : program_(program) {}

std::uint32_t Functions::of_symbol(const ElfSymbol& symbol) {
  const auto found = by_address_.find(symbol.address);
  if (found != by_address_.end()) return found->second;
  const auto number = count();
  places_.push_back({symbol.shown(), symbol.address, symbol.size});
  by_address_.emplace(symbol.address, number);
  return number;
}

bool Functions::may_leave_function(std::uint32_t pc, std::uint32_t next) const {
  const auto* to = program_.covering(next);
  return to != nullptr && to != program_.covering(pc);
}

std::uint32_t Functions::entered(std::uint32_t address) {
  auto& recent = recent_[address / 2 % recent_.size()];
  if (recent.address != address) recent = {address, find_entered(address)};
  return recent.place;
}

std::uint32_t Functions::find_entered(std::uint32_t address) {
  if (const auto* symbol = program_.covering(address)) return of_symbol(*symbol);
  const auto found = by_address_.find(address);
  if (found != by_address_.end()) return found->second;
  const auto number = count();
  places_.push_back({fmt::format("0x{:08x}", address), address, 0});
  by_address_.emplace(address, number);
  return number;
}

std::uint32_t Functions::reached(std::uint32_t address, std::uint32_t current) {
  if (inside(current, address)) return current;
  const auto* symbol = program_.covering(address);
  return symbol == nullptr ? current : of_symbol(*symbol);
}

std::uint32_t Functions::named(std::string_view name) {
  const auto found = by_name_.find(name);
  if (found != by_name_.end()) return found->second;
  const auto number = count();
  places_.push_back({std::string(name), 0, 0});
  by_name_.emplace(std::string(name), number);
  return number;
}

}  // namespace mebots::soc::observe
