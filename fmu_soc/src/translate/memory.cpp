// SPDX-License-Identifier: Apache-2.0
//
// What translated code knows of the first memory: its marks, its banks, and what else lies within reach of it.
#include "translate/emitter.hpp"

#include <limits>

namespace mebots::soc::translate {

/// Whether a table lies where r14 reaches it.
bool Emitter::near(const void* table, std::size_t size) const {
  const auto distance = static_cast<const std::uint8_t*>(table) - ram_[0].data;
  return distance >= std::numeric_limits<std::int32_t>::min() &&
         distance + static_cast<std::ptrdiff_t>(size) <= std::numeric_limits<std::int32_t>::max();
}

int Emitter::from_first_memory(const void* table) const {
  return static_cast<int>(static_cast<const std::uint8_t*>(table) - ram_[0].data);
}

/// The marks of one or two words of the first memory from that with number ecx; rdx may be lost.
Xbyak::Address Emitter::marks_of_word(unsigned words) {
  const auto& frame = words == 1 ? byte : word;
  if (near(ram_[0].marks, ram_[0].span)) return frame[r14 + rcx + from_first_memory(ram_[0].marks)];
  mov(rdx, ptr[rbx + static_cast<int>(offsetof(Execution, ram[0].marks))]);
  return frame[rdx + rcx];
}

/// Takes a cycle of a bank of the first memory for the access at offset eax, when others use it too. ecx, which may
/// hold the number of the word already, and edx are lost.
void Emitter::emit_claim(const Instruction* at, bool word_in_ecx) {
  if (options_.banks == nullptr) return;
  const auto host = [](std::size_t offset) { return static_cast<int>(offsetof(Execution, host) + offset); };
  const auto count = static_cast<int>(options_.banks->count());
  const auto distance = at->cycles_before * count;
  Label retry;
  Label taken;
  Label done;
  if (!word_in_ecx) rorx(ecx, eax, 2);
  and_(ecx, count - 1);
  L(retry);
  cmp(byte[r15 + rcx + distance], 0);
  jne(taken, T_NEAR);
  mov(byte[r15 + rcx + distance], 1);
  L(done);
  aside([this, retry, taken, done, host, count, distance]() mutable {
    L(taken);
    cmp(byte[rbx + host(offsetof(HostState, alone))], 0);
    jne(done, T_NEAR);
    add(r15, count);
    mov(rdx, reinterpret_cast<std::uint64_t>(options_.banks->horizon()));
    mov(rdx, ptr[rdx]);
    sub(rdx, distance);
    cmp(r15, rdx);
    jb(retry, T_NEAR);
    jmp(done, T_NEAR);
  });
}

}  // namespace mebots::soc::translate
