// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "translate/region.hpp"
#include "translate/xbyak.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace mebots::soc::translate {

class Assembler;

/// Number of host registers that hold guest registers.
inline constexpr unsigned kHostRegisters = 9;
/// Number of vector registers for operands of dot products, or for floats.
inline constexpr unsigned kVectorRegisters = 12;
/// Number of the first of these vector registers.
inline constexpr int kFirstVector = 3;
/// Number of guest registers: x0 to x31, f0 to f31, and the one that replaces x0 as a destination.
inline constexpr unsigned kGuestRegisters = kNoRegister + 1;

/// The guest registers that are in host registers in the whole region. All other guest registers are in memory.
struct Registers {
  static constexpr std::int8_t kInMemory = -1;

  std::array<std::int8_t, kGuestRegisters> host;  // number of the host register, or kInMemory
  std::array<std::uint8_t, kHostRegisters> guest{};
  unsigned count = 0;  // of host registers in use
  std::array<std::int8_t, kGuestRegisters>
      vector;  // number of the vector register that holds it in the low word, or kInMemory
  std::array<std::uint8_t, kVectorRegisters> vector_guest{};
  unsigned vector_count = 0;
  std::array<bool, kGuestRegisters> written{};  // true if the region writes it
};

/// Allocates registers. A guest register that is mostly used by dot products and floats gets a vector register. The
/// most used of the other guest registers get general-purpose host registers.
Registers allocate(const Region& region);

/// The locations of a region's guest registers. Writes the code that reads and writes these registers.
class RegisterMap {
 public:
  using Reg32 = Xbyak::Reg32;

  explicit RegisterMap(Assembler& assembler);

  void set_allocation(const Registers& allocation) { allocation_ = allocation; }
  /// load_all() and store_all() move the guest registers between memory and host registers. store_all() stores only
  /// registers that the region writes.
  void load_all();
  void store_all();

  bool in_host(unsigned reg) const { return allocation_.host[reg] != Registers::kInMemory; }
  bool in_vector(unsigned reg) const { return allocation_.vector[reg] != Registers::kInMemory; }
  Xbyak::Xmm vector(unsigned reg) const;
  Reg32 host(unsigned reg) const;
  static Xbyak::Address memory(unsigned reg);
  /// Returns a register as an operand of the host's instruction. The register must not be x0 or in a vector register.
  const Xbyak::Operand& operand(unsigned reg);
  /// Returns a register as an operand that is only read. The value of a vector register is copied to `scratch` first.
  const Xbyak::Operand& source(unsigned reg, const Reg32& scratch);
  /// Returns the host register that holds a register's value. The caller must not change the returned register unless
  /// it is `scratch`.
  Reg32 value(unsigned reg, const Reg32& scratch);
  /// Returns the vector register that holds a register's value. The caller must not change the returned register unless
  /// it is `scratch`.
  Xbyak::Xmm in_vector_for(unsigned reg, const Xbyak::Xmm& scratch);
  /// Returns the register for a result: the host register of guest register `rd`. If `rd` has no host register, or if
  /// its old value is still needed, returns `scratch`.
  Reg32 place(unsigned rd, const Reg32& scratch, bool needed_later = false) const;
  /// Writes a result to its register.
  void finish(unsigned rd, const Reg32& result);
  /// Writes a result in the low word of a vector register.
  void finish_vector(unsigned rd, const Xbyak::Xmm& result);
  /// Sets a register to a constant. May change ecx.
  void set(unsigned rd, std::uint32_t constant);
  /// Copies a register. Keeps the flags.
  void copy(const Reg32& to, unsigned reg);

 private:
  Assembler& a_;
  Registers allocation_;
  std::vector<Xbyak::Address> memory_operands_;  // by guest register
};

}  // namespace mebots::soc::translate
