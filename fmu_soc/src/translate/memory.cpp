// SPDX-License-Identifier: Apache-2.0
//
// Loads and stores in the two fast memories. What is misaligned, elsewhere, or stored where somebody must hear of it
// goes to the interpreter.
#include "translate/emitter.hpp"

#include <bit>
#include <limits>

namespace mebots::soc::translate {

/// False: not a load or store, or one that the interpreter had better do.
bool Emitter::emit_memory(const Instruction* at) {
  if (ram_[0].banks != nullptr || ram_[0].span == 0) return false;
  switch (at->op) {
    case Op::lb:
      emit_load(at, 1, true);
      return true;
    case Op::lbu:
      emit_load(at, 1, false);
      return true;
    case Op::lh:
      emit_load(at, 2, true);
      return true;
    case Op::lhu:
      emit_load(at, 2, false);
      return true;
    case Op::lw:
      emit_load(at, 4, false);
      return true;
    case Op::sb:
      emit_store(at, 1);
      return true;
    case Op::sh:
      emit_store(at, 2);
      return true;
    case Op::sw:
      emit_store(at, 4);
      return true;
    default:
      return false;
  }
}

/// eax = where the address lies in the first memory; goes to `other` when it does not, or is misaligned.
void Emitter::emit_address(const Instruction* at, unsigned size, Label& other) {
  const auto distance = static_cast<std::uint32_t>(at->imm) - ram_[0].base;
  if (at->rs1 == 0) {
    mov(eax, distance);
  } else {
    const auto base = value(at->rs1, eax);
    lea(eax, ptr[base.cvt64() + static_cast<std::int32_t>(distance)]);
  }
  check_address(eax, ecx, ram_[0], size, other);
}

/// Leaves the number of the word that an aligned access touches in `scratch` for words, else nothing of use.
void Emitter::check_address(const Reg32& offset, const Reg32& scratch, const FastRegion& ram, unsigned size,
                            Label& other) {
  const auto bytes = ram.span + 3;
  if (size == 1) {
    cmp(offset, bytes);
  } else {
    // Rotated, a misaligned offset is far too large.
    const auto shift = static_cast<unsigned>(std::countr_zero(size));
    rorx(scratch, offset, static_cast<std::uint8_t>(shift));
    cmp(scratch, bytes >> shift);
  }
  jae(other, T_NEAR);
}

void Emitter::fetch(const Reg32& to, const Xbyak::RegExp& from, unsigned size, bool sign) {
  if (size == 4) {
    mov(to, dword[from]);
  } else if (size == 2) {
    sign ? movsx(to, word[from]) : movzx(to, word[from]);
  } else {
    sign ? movsx(to, byte[from]) : movzx(to, byte[from]);
  }
}

void Emitter::emit_load(const Instruction* at, unsigned size, bool sign) {
  Label other;
  Label done;
  emit_address(at, size, other);
  const auto to = place(at->rd, eax);
  fetch(to, r14 + rax, size, sign);
  L(done);
  finish(at->rd, to);
  later([this, at, size, sign, to, other, done]() mutable {
    L(other);
    const auto& ram = ram_[1];
    if (ram.span == 0 || ram.banks != nullptr) {
      emit_resume(at);
      return;
    }
    Label neither;
    lea(ecx, ptr[rax + static_cast<std::int32_t>(ram_[0].base - ram.base)]);
    check_address(ecx, edx, ram, size, neither);
    inc(qword[rbx + static_cast<int>(offsetof(Execution, far_accesses))]);
    if (ram.wait_cycles != ram_[0].wait_cycles) {
      sub(r15, static_cast<std::int32_t>(ram.wait_cycles - ram_[0].wait_cycles));
    }
    mov(rdx, reinterpret_cast<std::uint64_t>(ram.data));
    fetch(to, rdx + rcx, size, sign);
    jmp(done, T_NEAR);
    L(neither);
    emit_resume(at);
  });
}

void Emitter::emit_store(const Instruction* at, unsigned size) {
  Label other;
  Label marked;
  Label done;
  const auto store = [this, at, size](const Xbyak::RegExp& where, const Reg32& scratch) {
    const auto from = value(at->rs2, scratch);
    if (size == 4) {
      mov(dword[where], from);
    } else if (size == 2) {
      mov(word[where], from.cvt16());
    } else {
      mov(byte[where], from.cvt8());
    }
  };
  emit_address(at, size, other);
  if (size != 4) {
    mov(ecx, eax);
    shr(ecx, 2);
  }
  const auto distance = ram_[0].marks - ram_[0].data;
  if (distance >= std::numeric_limits<std::int32_t>::min() && distance <= std::numeric_limits<std::int32_t>::max()) {
    cmp(byte[r14 + rcx + static_cast<int>(distance)], 0);
  } else {
    mov(rdx, ptr[rbx + static_cast<int>(offsetof(Execution, ram[0].marks))]);
    cmp(byte[rdx + rcx], 0);
  }
  jne(marked, T_NEAR);
  store(r14 + rax, ecx);
  L(done);
  later([this, at, size, store, other, marked, done]() mutable {
    L(other);
    const auto& ram = ram_[1];
    if (ram.span != 0 && ram.banks == nullptr) {
      lea(ecx, ptr[rax + static_cast<std::int32_t>(ram_[0].base - ram.base)]);
      check_address(ecx, edx, ram, size, marked);
      mov(eax, ecx);
      shr(eax, 2);
      mov(rdx, reinterpret_cast<std::uint64_t>(ram.marks));
      cmp(byte[rdx + rax], 0);
      jne(marked, T_NEAR);
      inc(qword[rbx + static_cast<int>(offsetof(Execution, far_accesses))]);
      if (ram.wait_cycles != ram_[0].wait_cycles) {
        sub(r15, static_cast<std::int32_t>(ram.wait_cycles - ram_[0].wait_cycles));
      }
      mov(rdx, reinterpret_cast<std::uint64_t>(ram.data));
      store(rdx + rcx, eax);
      jmp(done, T_NEAR);
    }
    L(marked);
    emit_resume(at);
  });
}

}  // namespace mebots::soc::translate
