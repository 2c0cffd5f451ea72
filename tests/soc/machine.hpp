// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "assembler.hpp"
#include "hart/hart.hpp"
#include "memory/bus.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace mebots::soc::test {

/// A hart with 1 MiB of RAM at 0x80000000 and 4 KiB at 0x70000000, no devices. A program ends by storing into `tohost`.
class Machine : private Bus {
 public:
  static constexpr std::uint32_t kRam = 0x80000000;
  static constexpr std::uint32_t kSmallRam = 0x70000000;

  explicit Machine(const Elf& program, CoreKind kind = CoreKind::cv32e40p);
  explicit Machine(std::string_view text, CoreKind kind = CoreKind::cv32e40p) : Machine(assemble(text), kind) {}

  /// Runs until tohost is stored, the core faults or sleeps, or `limit` cycles.
  Stop run(std::uint64_t limit = 10'000'000) { return hart_.run(limit); }

  /// Its code comes through an instruction cache from now on.
  InstructionCache& fetch_through(const InstructionCacheSettings& settings) {
    hart_.fetch_through(instruction_cache_.emplace(settings));
    return *instruction_cache_;
  }

  Hart& hart() { return hart_; }
  InstructionCache* instruction_cache() { return instruction_cache_ ? &*instruction_cache_ : nullptr; }
  Memory& memory() { return memory_; }
  const Elf& program() const { return program_; }
  std::uint32_t reg(unsigned index) const { return hart_.reg(index); }
  std::uint32_t word(std::uint32_t address) const;
  std::uint32_t word(std::string_view symbol, std::uint32_t index = 0) const;

 private:
  static Memory make_memory();
  BusReply load(std::uint32_t, std::uint64_t) override { return {}; }
  BusReply store(std::uint32_t, std::uint64_t, std::uint32_t) override { return {}; }
  bool watched(std::uint32_t address) override { return word(address & ~3U) != 0; }

  Elf program_;
  Memory memory_;
  std::optional<InstructionCache> instruction_cache_;
  Hart hart_;
};

/// Ends a program: stores 1 into tohost.
inline constexpr std::string_view kEnd = R"(
    li t6, 1
    la t5, tohost
    sw t6, 0(t5)
1:  j 1b
    .section .tohost, "aw"
    .balign 64
    .globl tohost
tohost: .word 0, 0
    .text
)";

}  // namespace mebots::soc::test
