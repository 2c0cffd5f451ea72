// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/data_path.hpp"
#include "hart/execution.hpp"
#include "hart/handler.hpp"
#include "hart/ram_access.hpp"

#include <cstring>
#include <type_traits>

/// Loads and stores of RV32I, and those of Xpulp v2 with other address modes.
namespace mebots::soc {

namespace translate {
class Assembler;
}

namespace load_store {

using Mode = AddressMode;

constexpr bool is_post(Mode mode) {
  return mode == Mode::post_immediate || mode == Mode::post_register;
}

/// Adds the extra cycle of a misaligned load. A jump directly after this load takes only one cycle.
[[gnu::always_inline]] inline void misaligned_load(Execution& e, const Instruction* at) {
  e.extra_cycles += kMisalignedExtra;
  e.slow_load = at;
  if (overlaps_slow(executed(at[0], true), {at[1].op, at[1].rd, at[1].rs1})) {
    e.extra_cycles -= static_cast<std::uint32_t>(at[2].cycles_before - at[1].cycles_before - 1);
  }
}

/// Returns whether an access on the slow path was performed. False if it raised an exception or was deferred.
inline bool retired(const Execution& e, const Instruction* at) {
  return e.exit == at + 1;
}

/// Writes the incremented address back to the address register. x0 stays 0.
[[gnu::always_inline]] inline void increment(Execution& e, const Instruction* at, std::uint32_t value) {
  e.x[at->rs1] = value;
  e.x[0] = 0;
}

/// The address of an access, and the new value of its address register.
struct Addresses {
  std::uint32_t access;
  std::uint32_t moved;
};

/// `in` is the number of the register with the offset or increment. It is rs2 for a load, and `imm` for a store.
template <Mode kMode>
[[gnu::always_inline]] inline Addresses addresses_of(const Execution& e, const Instruction* at, std::uint32_t in) {
  const auto base = e.x[at->rs1];
  const auto moved = base + (has_step_register(kMode) ? e.x[in] : static_cast<std::uint32_t>(at->imm));
  return {is_post(kMode) ? base : moved, moved};
}

/// Completes a load. If the load writes its own address register, this register receives the loaded value.
template <typename T, Mode kMode>
[[gnu::always_inline]] inline void finish_load(Execution& e, const Instruction* at, const std::uint8_t* data,
                                               std::uint32_t moved) {
  T value;
  std::memcpy(&value, data, sizeof value);
  if constexpr (is_post(kMode)) increment(e, at, moved);
  e.x[at->rd] = static_cast<std::uint32_t>(static_cast<std::int32_t>(value));
}

template <typename T, Mode kMode>
[[gnu::noinline]] const Instruction* careful_load(Execution& e, const Instruction* at) {
  const auto address = addresses_of<kMode>(e, at, at->rs2);
  const auto ram = ram_access<sizeof(T)>(e, at, address.access);
  if (ram.data == nullptr) {
    const auto* left = e.units->data_path.load(at, address.access, sizeof(T), std::is_signed_v<T>);
    if (is_post(kMode) && retired(e, at) && at->rd != at->rs1) increment(e, at, address.moved);
    return left;
  }
  finish_load<T, kMode>(e, at, ram.data, address.moved);
  if (crosses_word(address.access, sizeof(T))) misaligned_load(e, at);
  return next(e, at);
}

template <typename T, Mode kMode>
[[gnu::always_inline]] inline const Instruction* load(Execution& e, const Instruction* at) {
  const auto address = addresses_of<kMode>(e, at, at->rs2);
  const auto ram = quick_access<sizeof(T)>(e, address.access);
  if (ram.data == nullptr) [[unlikely]]
    return careful_load<T, kMode>(e, at);
  finish_load<T, kMode>(e, at, ram.data, address.moved);
  return next(e, at);
}

template <typename T, Mode kMode>
[[gnu::always_inline]] inline void finish_store(Execution& e, const Instruction* at, std::uint8_t* data,
                                                std::uint32_t moved) {
  const auto value = static_cast<T>(e.x[at->rs2]);
  std::memcpy(data, &value, sizeof value);
  if constexpr (is_post(kMode)) increment(e, at, moved);
}

template <typename T, Mode kMode>
[[gnu::noinline]] const Instruction* careful_store(Execution& e, const Instruction* at) {
  const auto address = addresses_of<kMode>(e, at, static_cast<std::uint32_t>(at->imm));
  const auto ram = ram_access<sizeof(T)>(e, at, address.access);
  if (ram.data == nullptr) {
    const auto* left = e.units->data_path.store(at, address.access, sizeof(T), e.x[at->rs2]);
    if (is_post(kMode) && retired(e, at)) increment(e, at, address.moved);
    return left;
  }
  finish_store<T, kMode>(e, at, ram.data, address.moved);
  std::uint8_t marks = ram.marks[0];
  if (crosses_word(address.access, sizeof(T))) {
    e.extra_cycles += kMisalignedExtra;
    marks |= ram.marks[1];
  }
  return marks != 0 ? e.units->data_path.stored_over_mark(at, address.access, sizeof(T)) : next(e, at);
}

template <typename T, Mode kMode>
[[gnu::always_inline]] inline const Instruction* store(Execution& e, const Instruction* at) {
  const auto address = addresses_of<kMode>(e, at, static_cast<std::uint32_t>(at->imm));
  const auto ram = quick_access<sizeof(T)>(e, address.access);
  if (ram.data == nullptr) [[unlikely]]
    return careful_store<T, kMode>(e, at);
  finish_store<T, kMode>(e, at, ram.data, address.moved);
  if (*ram.marks != 0) [[unlikely]]
    return e.units->data_path.stored_over_mark(at, address.access, sizeof(T));
  return next(e, at);
}

template <std::uint8_t kSize, bool kSign>
using Moved = std::conditional_t<kSize == 4, std::int32_t,
                                 std::conditional_t<kSize == 2, std::conditional_t<kSign, std::int16_t, std::uint16_t>,
                                                    std::conditional_t<kSign, std::int8_t, std::uint8_t>>>;

}  // namespace load_store

template <Op kOp>
const Instruction* execute_load(Execution& e, const Instruction* at) {
  constexpr auto kTraits = traits_of(kOp);
  return load_store::load<load_store::Moved<kTraits.size, kTraits.sign>, kTraits.mode>(e, at);
}
template <Op kOp>
const Instruction* execute_store(Execution& e, const Instruction* at) {
  constexpr auto kTraits = traits_of(kOp);
  return load_store::store<std::make_unsigned_t<load_store::Moved<kTraits.size, false>>, kTraits.mode>(e, at);
}

/// Writes host code for a load or store. Returns false if the core has no fast memory.
bool emit_load(translate::Assembler& c, const Instruction* at);
bool emit_store(translate::Assembler& c, const Instruction* at);

}  // namespace mebots::soc
