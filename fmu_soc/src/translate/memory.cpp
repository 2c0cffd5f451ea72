// SPDX-License-Identifier: Apache-2.0
//
// Loads and stores in the two fast memories. What is misaligned in the second one, elsewhere, or stored where somebody
// must hear of it goes to the interpreter.
#include "translate/emitter.hpp"

#include <bit>
#include <limits>

namespace mebots::soc::translate {

namespace {

/// The register with the offset or the increment.
unsigned step_register(const Instruction* at) {
  return is_store(at->op) ? static_cast<unsigned>(at->imm) : at->rs2;
}

}  // namespace

/// eax = where the address lies in the first memory; goes to `other` when it does not, or is misaligned.
/// Behind the label that comes back it does.
Xbyak::Label Emitter::emit_address(const Instruction* at, unsigned size, Label& other) {
  const auto mode = traits_of(at->op).mode;
  const auto imm = mode == AddressMode::offset ? static_cast<std::uint32_t>(at->imm) : 0U;
  const auto distance = imm - ram_[0].base;
  if (at->rs1 == 0) {
    mov(eax, distance);
  } else {
    const auto base = value(at->rs1, eax);
    lea(eax, ptr[base.cvt64() + static_cast<std::int32_t>(distance)]);
  }
  if (const auto step = step_register(at); mode == AddressMode::offset_register && step != 0)
    add(eax, source(step, ecx));
  Label inside;
  check_address(eax, ecx, ram_[0], size, other);
  L(inside);
  return inside;
}

/// In place of an address check that failed: half a word in the middle of a word is one access like any other.
void Emitter::emit_middle_of_word(unsigned size, Label& inside) {
  if (size != 2) return;
  Label other;
  mov(ecx, eax);
  and_(ecx, 3);
  cmp(ecx, 1);
  jne(other);
  cmp(eax, ram_[0].span);
  jb(inside, T_NEAR);
  L(other);
}

/// Likewise for bytes of two words: two accesses. Stores go to `marked` when somebody must hear of them. A load near
/// the end of its block is left to the interpreter, since what comes behind may depend on it.
void Emitter::emit_across_words(const Instruction* at, unsigned size, Label& marked, Label& claimed) {
  if (size == 1 || (is_load(at->op) && (is_block_end(at[1].op) || is_block_end(at[2].op)))) return;
  Label other;
  cmp(eax, ram_[0].span);
  jae(other, T_NEAR);
  if (is_store(at->op)) {
    mov(ecx, eax);
    shr(ecx, 2);
    cmp(marks_of_word(2), 0);
    jne(marked, T_NEAR);
  } else {
    mov(rdx, reinterpret_cast<std::uint64_t>(at));
    mov(ptr[rbx + static_cast<int>(offsetof(Execution, host.slow_load))], rdx);
    movq(ptr[rbx + static_cast<int>(offsetof(Execution, host.slow_load_when))], xmm15);
  }
  emit_claim(at, false);
  spend(kMisalignedExtra + ram_[0].wait_cycles);
  if (options_.banks != nullptr) {
    add(eax, 4);
    emit_claim(at, false);
    sub(eax, 4);
  }
  jmp(claimed, T_NEAR);
  L(other);
}

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

/// Adds to the address register of a post-increment; ecx and edx are lost.
void Emitter::emit_increment(const Instruction* at) {
  const auto mode = traits_of(at->op).mode;
  if (at->rs1 == 0 || (is_load(at->op) && at->rd == at->rs1)) return;  // what is loaded wins
  const auto add_to = [this, at, mode](const Xbyak::Operand& to) {
    if (mode == AddressMode::post_immediate) {
      add(to, static_cast<std::uint32_t>(at->imm));
    } else if (mode == AddressMode::post_register && step_register(at) != 0) {
      add(to, value(step_register(at), edx));
    }
  };
  if (!in_vector(at->rs1)) {
    add_to(operand(at->rs1));
  } else if (is_post_increment(at->op)) {
    copy(ecx, at->rs1);
    add_to(ecx);
    finish(at->rs1, ecx);
  }
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

/// False: there is no fast memory.
bool Emitter::emit_load(const Instruction* at) {
  if (ram_[0].span == 0) return false;
  const unsigned size = traits_of(at->op).size;
  const bool sign = traits_of(at->op).sign;
  Label other;
  Label claimed;
  Label done;
  auto inside = emit_address(at, size, other);
  emit_claim(at, size == 4);
  L(claimed);
  // An increment by the register that is loaded reads it first.
  const bool is_own_step = traits_of(at->op).mode == AddressMode::post_register && step_register(at) == at->rd;
  const auto to = place(at->rd, eax, is_own_step);
  const bool into_vector = size == 4 && in_vector(at->rd) && !is_own_step;
  const auto take = [this, at, size, sign, to, into_vector](const Xbyak::RegExp& from) {
    if (into_vector) {
      movd(vector(at->rd), dword[from]);
    } else {
      fetch(to, from, size, sign);
    }
  };
  take(r14 + rax);
  L(done);
  emit_increment(at);
  if (!into_vector) finish(at->rd, to);
  later([this, at, size, take, other, claimed, done, inside]() mutable {
    L(other);
    emit_middle_of_word(size, inside);
    emit_across_words(at, size, claimed, claimed);
    const auto& ram = ram_[1];
    if (ram.span == 0) {
      emit_resume(at);
      return;
    }
    Label neither;
    lea(ecx, ptr[rax + static_cast<std::int32_t>(ram_[0].base - ram.base)]);
    check_address(ecx, edx, ram, size, neither);
    emit_far_wait(at, neither);
    mov(rdx, reinterpret_cast<std::uint64_t>(ram.data));
    take(rdx + rcx);
    jmp(done, T_NEAR);
    L(neither);
    emit_resume(at);
  });
  return true;
}

/// As of loads.
bool Emitter::emit_store(const Instruction* at) {
  if (ram_[0].span == 0) return false;
  const unsigned size = traits_of(at->op).size;
  Label other;
  Label marked;
  Label claimed;
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
  auto inside = emit_address(at, size, other);
  if (size != 4) {
    mov(ecx, eax);
    shr(ecx, 2);
  }
  cmp(marks_of_word(1), 0);
  jne(marked, T_NEAR);
  emit_claim(at, true);
  L(claimed);
  store(r14 + rax, ecx);
  L(done);
  emit_increment(at);
  later([this, at, size, store, other, marked, claimed, done, inside]() mutable {
    L(other);
    emit_middle_of_word(size, inside);
    emit_across_words(at, size, marked, claimed);
    const auto& ram = ram_[1];
    if (ram.span != 0) {
      lea(ecx, ptr[rax + static_cast<std::int32_t>(ram_[0].base - ram.base)]);
      check_address(ecx, edx, ram, size, marked);
      mov(eax, ecx);
      shr(eax, 2);
      mov(rdx, reinterpret_cast<std::uint64_t>(ram.marks));
      cmp(byte[rdx + rax], 0);
      jne(marked, T_NEAR);
      emit_far_wait(at, marked);
      mov(rdx, reinterpret_cast<std::uint64_t>(ram.data));
      store(rdx + rcx, eax);
      jmp(done, T_NEAR);
    }
    L(marked);
    emit_resume(at);
  });
  return true;
}

/// Counts an access to the second memory at offset ecx, and spends what it waits; eax and edx are lost. Goes to `left`,
/// with nothing done, where the interpreter must make it.
void Emitter::emit_far_wait(const Instruction* at, Label& left) {
  const auto& ram = ram_[1];
  if (ram.is_shared()) {
    mov(edx, at->cycles_before);
    call(gates_.far);
    test(eax, eax);
    js(left, T_NEAR);
    return;
  }
  inc(qword[rbx + static_cast<int>(offsetof(Execution, counters.far_accesses))]);
  if (ram.wait_cycles != ram_[0].wait_cycles) spend(ram.wait_cycles - ram_[0].wait_cycles);
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
