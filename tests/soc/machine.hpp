// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "assembler.hpp"
#include "memory/bus.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"
#include "runs/hart.hpp"

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace mebots::soc::test {

/// By default, a machine is a generic RV32IMC core without instruction cache and options.
struct MachineSettings {
  CoreKind kind = CoreKind::rv32imc;
  InstructionCacheSettings instruction_cache = {};
  bool loose_limit = false;
  bool translate = true;
  Extensions options = {};
  unsigned pmp_entries = 0;
};

/// Simulates a hart with 1 MiB of RAM at 0x80000000 and 4 KiB at 0x70000000. A store into `tohost` ends a program. The
/// only device has two registers with the number of the cycle. Loads from the first register are quiet: see
/// Bus::load_quietly().
class Machine : private Bus {
 public:
  static constexpr std::uint32_t kRam = 0x80000000;
  static constexpr std::uint32_t kSmallRam = 0x70000000;
  static constexpr std::uint32_t kQuietClock = 0x40000000;
  static constexpr std::uint32_t kClock = 0x40000004;

  explicit Machine(const Elf& program, const MachineSettings& settings = {});
  Machine(const Elf& program, CoreKind kind) : Machine(program, MachineSettings{.kind = kind}) {}
  explicit Machine(std::string_view text, CoreKind kind = CoreKind::rv32imc) : Machine(assemble(text), kind) {}

  /// Runs until the program stores into tohost, the core faults or sleeps, or `limit` cycles have passed.
  Stop run(std::uint64_t limit = 10'000'000) { return hart_.run(limit); }

  Hart& hart() { return hart_; }
  /// Returns the cache; null if there is none.
  InstructionCache* instruction_cache() { return instruction_cache_.get(); }
  Memory& memory() { return memory_; }
  const Elf& program() const { return program_; }
  std::uint32_t reg(unsigned index) const { return hart_.reg(index); }
  std::uint32_t word(std::uint32_t address) const;
  std::uint32_t word(std::string_view symbol, std::uint32_t index = 0) const;

 private:
  static Memory make_memory();
  BusReply load(std::uint32_t address, std::uint64_t cycle) override {
    return address == kClock ? BusReply::done(static_cast<std::uint32_t>(cycle), 2) : BusReply{};
  }
  BusReply load_quietly(std::uint32_t address, std::uint64_t cycle, unsigned size) noexcept override {
    if (address != kQuietClock || size != 4) return {};
    auto reply = BusReply::done(static_cast<std::uint32_t>(cycle), 3);
    reply.is_quiet = true;
    return reply;
  }
  BusReply store(std::uint32_t, std::uint64_t, std::uint32_t) override { return {}; }
  bool watched(std::uint32_t address) override { return word(address & ~3U) != 0; }

  Elf program_;
  Memory memory_;
  std::unique_ptr<InstructionCache> instruction_cache_;
  DecodedCode code_;
  Hart hart_;
};

/// Assembly text that ends a program: it stores 1 into tohost.
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
