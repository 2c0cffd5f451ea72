// SPDX-License-Identifier: Apache-2.0
#include "machine.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

namespace mebots::soc::test {

Memory Machine::make_memory() {
  Memory memory;
  memory.add("ram", kRam, 1U << 20);
  memory.add("small", kSmallRam, 4096);
  return memory;
}

namespace {

/// The energies differ for all kinds of instructions, so that no sum is right by chance.
InstructionEnergy energies() {
  InstructionEnergy energy;
  for (std::size_t i = 0; i < energy.fj.size(); ++i) energy.fj[i] = static_cast<std::uint32_t>(1000 + 37 * i);
  return energy;
}

}  // namespace

Machine::Machine(const Elf& program, const MachineSettings& settings)
    : program_(program),
      memory_(make_memory()),
      instruction_cache_(make_instruction_cache(settings.instruction_cache, InstructionCache::Users::one)),
      code_(memory_, {.timing = {settings.kind, settings.options, settings.pmp_entries},
                      .energy = energies(),
                      .loose_limit = settings.loose_limit,
                      .instruction_cache = instruction_cache_.get(),
                      .translate = settings.translate}),
      hart_(memory_, *this, code_) {
  for (const auto& segment : program_.segments()) {
    if (!memory_.write(segment.load_address, segment.bytes)) throw Error("test program outside the RAM");
  }
  if (const auto tohost = program_.symbol("tohost")) memory_.mark(*tohost, 4, Region::kWatch);
  hart_.reset(program_.entry());
}

std::uint32_t Machine::word(std::uint32_t address) const {
  std::uint32_t value = 0;
  if (!memory_.read(address, {reinterpret_cast<std::uint8_t*>(&value), sizeof value})) {
    throw Error(fmt::format("no RAM at 0x{:08x}", address));
  }
  return value;
}

std::uint32_t Machine::word(std::string_view symbol, std::uint32_t index) const {
  const auto address = program_.symbol(symbol);
  if (!address) throw Error(fmt::format("no symbol {}", symbol));
  return word(*address + 4 * index);
}

}  // namespace mebots::soc::test
