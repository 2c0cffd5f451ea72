// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string_view>

namespace mebots::soc::test {

/// Common base of the generators of random assembler text.
class RandomText {
 protected:
  explicit RandomText(std::uint32_t seed) : random_(seed) {}

  static constexpr std::array<std::string_view, 18> kTwoSources{"add",   "sub",    "sll", "slt",  "sltu", "xor",
                                                                "srl",   "sra",    "or",  "and",  "mul",  "mulh",
                                                                "mulhu", "mulhsu", "div", "divu", "rem",  "remu"};
  static constexpr std::array<std::string_view, 6> kImmediates{"addi", "slti", "sltiu", "xori", "ori", "andi"};
  static constexpr std::array<std::string_view, 6> kBranches{"beq", "bne", "blt", "bge", "bltu", "bgeu"};
  static constexpr std::array<std::string_view, 5> kLoads{"lw", "lh", "lhu", "lb", "lbu"};
  static constexpr std::array<std::string_view, 3> kStores{"sw", "sh", "sb"};

  unsigned below(unsigned count) { return static_cast<unsigned>(random_() % count); }
  template <std::size_t Count>
  std::string_view any(const std::array<std::string_view, Count>& list) {
    return list[below(Count)];
  }
  int immediate() { return static_cast<int>(below(4096)) - 2048; }

  std::mt19937 random_;
};

}  // namespace mebots::soc::test
