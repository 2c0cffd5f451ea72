// SPDX-License-Identifier: Apache-2.0
#include "hart/csr_numbers.hpp"

#include <fmt/core.h>

#include <array>
#include <cstddef>

namespace mebots::soc::csr {
namespace {

struct Row {
  unsigned number;
  unsigned count;
  std::string_view name;
  unsigned first;  // number in the name of the first register
  Core core;
};

constexpr auto kRows = std::to_array<Row>({
#define MEBOTS_CSR(constant, number, count, name, first, core, ...) {number, count, name, first, Core::core},
#include "hart/csrs.inc"
});

constexpr bool is_single(const Row& row) {
  return row.core == Core::every && row.count == 1;
}

constexpr std::size_t count_singles() {
  std::size_t number = 0;
  for (const auto& row : kRows) number += is_single(row) ? 1 : 0;
  return number;
}

constexpr auto kNamed = [] {
  std::array<Named, count_singles()> named{};
  std::size_t i = 0;
  for (const auto& row : kRows) {
    if (is_single(row)) named[i++] = {row.number, row.name};
  }
  return named;
}();

}  // namespace

std::span<const Named> named() {
  return kNamed;
}

std::string name(unsigned number) {
  for (const auto& row : kRows) {
    if (number < row.number || number >= row.number + row.count) continue;
    const auto place = row.name.find('#');
    if (place == std::string_view::npos) return std::string(row.name);
    return fmt::format("{}{}{}", row.name.substr(0, place), number - row.number + row.first,
                       row.name.substr(place + 1));
  }
  return fmt::format("csr0x{:03x}", number);
}

}  // namespace mebots::soc::csr
