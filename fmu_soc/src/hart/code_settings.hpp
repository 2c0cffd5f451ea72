// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/timing.hpp"
#include "isa/op.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

class Banks;
class InstructionCache;

/// Energy of one instruction by kind [fJ], at the reference voltage.
struct InstructionEnergy {
  std::array<std::uint32_t, kOpCount> fj{};
};

/// What harts have in common that share decoded code. Cache and banks outlive it.
struct CodeSettings {
  Timing timing = {};
  InstructionEnergy energy = {};
  /// A block that starts before the limit of a run goes on to its end. So memory and pc alone say where a hart stops.
  bool loose_limit = false;
  InstructionCache* instruction_cache = nullptr;  // that the code comes through; null = fetching never waits
  Banks* banks = nullptr;  // of the first memory, when its users may have to wait for each other; null = one user
  bool translate = true;   // hot code to host code, where that is possible; counts are the same without
};

/// Settings of one hart, which never change; CodeSettings has those that harts share.
struct HartSettings {
  std::uint32_t id = 0;  // what mhartid reads
  /// Traps enter the address written to mtvec, also if the core clears some of its low bits.
  bool keeps_written_mtvec = false;
  /// Interrupts are those of GAP8's cores: 32 lines of an event unit, one of which is up, without mie; vectors at
  /// mtvec, whose low eight bits are 0; exceptions behind them. Source: RI5CY's user manual of 2018, chapters on
  /// exceptions and CSRs.
  bool has_gap8_interrupts = false;
};

}  // namespace mebots::soc
