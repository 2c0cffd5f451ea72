// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace mebots::soc::test {

/// A second implementation of Xpulp v2. It follows the tables of the RI5CY user manual 4.45, and shares no code with
/// the simulator's encoding table, decoder and operations.
class XpulpReference {
 public:
  struct Loop {
    std::uint32_t start = 0;
    std::uint32_t end = 0;
    std::uint32_t count = 0;
  };
  std::array<std::uint32_t, 32> x{};
  std::uint32_t pc = 0;
  std::array<Loop, 2> loops{};
  std::uint32_t ram_base = 0;
  std::vector<std::uint8_t> ram;
  // The range of offsets in the RAM at which stores have written.
  std::uint32_t written_from = 0;
  std::uint32_t written_to = 0;

  /// Executes one instruction at the pc. If it is not Xpulp, or if its access leaves the RAM, returns false without
  /// effect.
  bool step(std::uint32_t word);

 private:
  bool execute(std::uint32_t word, std::uint32_t& next_pc);
  bool load(std::uint32_t word, bool post);
  bool store(std::uint32_t word, bool post);
  bool alu(std::uint32_t word);
  bool bits(std::uint32_t word);
  bool shifted(std::uint32_t word);
  bool simd(std::uint32_t word);
  bool loop(std::uint32_t word);
  std::optional<std::int64_t> read(std::uint32_t address, unsigned bytes, bool sign) const;
  bool write(std::uint32_t address, unsigned bytes, std::uint32_t value);
};

}  // namespace mebots::soc::test
