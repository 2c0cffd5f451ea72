// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "translate/region.hpp"

#include <xbyak/xbyak.h>

#include <array>
#include <cstdint>
#include <vector>

namespace mebots::soc::translate {

class Assembler;

/// Number of host registers that hold guest registers.
inline constexpr unsigned kHostRegisters = 9;
/// Number of vector registers that do: what dot products work on.
inline constexpr unsigned kVectorRegisters = 12;
/// The host's number of the first of them.
inline constexpr int kFirstVector = 3;
/// Number of guest registers: x0 to x31, and the one that takes what is written to x0.
inline constexpr unsigned kGuestRegisters = 33;

/// Which guest registers are in host registers all through a region; the others stay in memory.
struct Registers {
  static constexpr std::int8_t kInMemory = -1;

  std::array<std::int8_t, 33> host;  // number of the host register, or kInMemory
  std::array<std::uint8_t, kHostRegisters> guest{};
  unsigned count = 0;                  // of host registers in use
  std::array<std::int8_t, 33> vector;  // number of the vector register whose low word it is, or kInMemory
  std::array<std::uint8_t, kVectorRegisters> vector_guest{};
  unsigned vector_count = 0;
  std::array<bool, 33> written{};  // somewhere in the region
};

/// Gives the vector registers to those that dot products use most and that are used by little else, and the host
/// registers to those of the others that are used most.
Registers allocate(const Region& region);

/// Where the guest registers of a region are, and the code that reads and writes them.
class RegisterMap {
 public:
  using Reg32 = Xbyak::Reg32;

  explicit RegisterMap(Assembler& assembler);

  void set_allocation(const Registers& allocation) { allocation_ = allocation; }
  /// Loads and stores all that are in host registers; stores only what the region writes.
  void load_all();
  void store_all();

  bool in_host(unsigned reg) const { return allocation_.host[reg] != Registers::kInMemory; }
  bool in_vector(unsigned reg) const { return allocation_.vector[reg] != Registers::kInMemory; }
  Xbyak::Xmm vector(unsigned reg) const;
  Reg32 host(unsigned reg) const;
  static Xbyak::Address memory(unsigned reg);
  /// A register as an operand of the host's instruction; neither x0 nor one in a vector register.
  const Xbyak::Operand& operand(unsigned reg);
  /// The same to be read only; from `scratch` if it is in a vector register.
  const Xbyak::Operand& source(unsigned reg, const Reg32& scratch);
  /// A register's value in a host register, which must not be changed unless it is `scratch`.
  Reg32 value(unsigned reg, const Reg32& scratch);
  /// A register's value in a vector register, which must not be changed unless it is `scratch`.
  Xbyak::Xmm in_vector_for(unsigned reg, const Xbyak::Xmm& scratch);
  /// Where to compute a result: the register's own place, or `scratch` if it has none or is needed until the end.
  Reg32 place(unsigned rd, const Reg32& scratch, bool needed_later = false) const;
  /// Writes a result to its register.
  void finish(unsigned rd, const Reg32& result);
  /// Writes a result in the low word of a vector register.
  void finish_vector(unsigned rd, const Xbyak::Xmm& result);
  /// ecx may be lost.
  void set(unsigned rd, std::uint32_t constant);
  /// Flags stay.
  void copy(const Reg32& to, unsigned reg);

 private:
  Assembler& a_;
  Registers allocation_;
  std::vector<Xbyak::Address> memory_operands_;  // by guest register
};

}  // namespace mebots::soc::translate
