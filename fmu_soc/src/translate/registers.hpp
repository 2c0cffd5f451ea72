// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "translate/region.hpp"
#include "translate/xbyak.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace mebots::soc::translate {

class Assembler;

inline constexpr unsigned kHostRegisters = 9;
/// Number of vector registers that can hold guest registers. These are operands of dot products and of floating-point
/// operations.
inline constexpr unsigned kVectorRegisters = 12;
/// Number of the first vector register that holds guest registers.
inline constexpr int kFirstVector = 3;
/// Number of guest registers: x0 to x31, f0 to f31, and kNoRegister.
inline constexpr unsigned kGuestRegisters = kNoRegister + 1;

/// Assignment of guest registers to host registers for a whole region. Guest registers without a host register are in
/// memory.
struct Registers {
  static constexpr std::int8_t kInMemory = -1;

  std::array<std::int8_t, kGuestRegisters> host;  // number of the host register, or kInMemory
  std::array<std::uint8_t, kHostRegisters> guest{};
  unsigned count = 0;  // number of host registers in use
  std::array<std::int8_t, kGuestRegisters>
      vector;  // number of the vector register that contains it in the low word, or kInMemory
  std::array<std::uint8_t, kVectorRegisters> vector_guest{};
  unsigned vector_count = 0;
  std::array<bool, kGuestRegisters> written{};  // true if the region writes the guest register
};

/// Assigns registers. A guest register that is mostly used by dot products and floats gets a vector register. Of the
/// others, those with the most uses get general-purpose registers.
Registers allocate(const Region& region);

/// Writes the code that reads and writes guest registers, in host registers or in memory.
class RegisterMap {
 public:
  using Reg32 = Xbyak::Reg32;

  explicit RegisterMap(Assembler& assembler);

  void set_allocation(const Registers& allocation) { allocation_ = allocation; }
  /// load_all() and store_all() write code that moves guest registers from and to memory. store_all() only stores
  /// registers that the region writes.
  void load_all();
  void store_all();

  bool in_host(unsigned reg) const { return allocation_.host[reg] != Registers::kInMemory; }
  bool in_vector(unsigned reg) const { return allocation_.vector[reg] != Registers::kInMemory; }
  Xbyak::Xmm vector(unsigned reg) const;
  Reg32 host(unsigned reg) const;
  static Xbyak::Address memory(unsigned reg);
  /// Returns a register as an operand. The register must not be x0 or in a vector register.
  const Xbyak::Operand& operand(unsigned reg);
  /// Returns a register as an operand that may only be read. If the value is in a vector register, writes code that
  /// copies it to `scratch`.
  const Xbyak::Operand& source(unsigned reg, const Reg32& scratch);
  /// Returns a host register with the value of guest register `reg`. The caller must not change it unless it is
  /// `scratch`.
  Reg32 value(unsigned reg, const Reg32& scratch);
  /// Returns a vector register with the value of guest register `reg`. The caller must not change it unless it is
  /// `scratch`.
  Xbyak::Xmm in_vector_for(unsigned reg, const Xbyak::Xmm& scratch);
  /// Returns the register to which an instruction should write its result for `rd`. This is `scratch` if `rd` is in no
  /// general-purpose register, or if `needed_later` is true because the old value of `rd` is still needed.
  Reg32 place(unsigned rd, const Reg32& scratch, bool needed_later = false) const;
  /// Writes code that moves a result to `rd`.
  void finish(unsigned rd, const Reg32& result);
  /// Writes code that moves a result in the low word of a vector register to `rd`.
  void finish_vector(unsigned rd, const Xbyak::Xmm& result);
  /// Writes code that sets a register to a constant. The code may change ecx.
  void set(unsigned rd, std::uint32_t constant);
  /// Writes code that copies a register. The code keeps the flags.
  void copy(const Reg32& to, unsigned reg);

 private:
  Assembler& a_;
  Registers allocation_;
  std::vector<Xbyak::Address> memory_operands_;  // indexed by guest register
};

}  // namespace mebots::soc::translate
