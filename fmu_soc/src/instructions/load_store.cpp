// SPDX-License-Identifier: Apache-2.0
//
// Lowering of loads and stores in the two fast memories. The interpreter performs other accesses, such as misaligned
// accesses to the second memory and stores to words that have a mark (see Region).
#include "instructions/load_store.hpp"

#include "mebots/assert.hpp"

#ifdef MEBOTS_TRANSLATES
#include "instructions/lowering.hpp"

#include <bit>

namespace mebots::soc {
namespace {

using namespace lowering;

/// Returns the number of the register that contains the offset or increment.
unsigned step_register(const Instruction* at) {
  return is_store(at->op) ? static_cast<unsigned>(at->imm) : at->rs2;
}

/// Writes a jump to `other`, taken if the offset is outside the memory or misaligned. If `size` is above 1, the code
/// also sets `scratch` to the offset divided by `size`.
void check_address(Assembler& c, const Reg32& offset, const Reg32& scratch, const FastRegion& ram, unsigned size,
                   Label& other) {
  const auto bytes = ram.span + 3;
  if (size == 1) {
    c.cmp(offset, bytes);
  } else {
    // A misaligned offset has low bits other than 0. The rotation makes them the highest bits, so that one comparison
    // detects misaligned offsets and offsets outside the memory.
    const auto shift = static_cast<unsigned>(std::countr_zero(size));
    c.rorx(scratch, offset, static_cast<std::uint8_t>(shift));
    c.cmp(scratch, bytes >> shift);
  }
  c.jae(other, kNear);
}

/// Writes code that computes in eax the offset of the address from the start of the first memory. The code jumps to
/// `other` if the address is outside this memory or misaligned. Returns a label at the end of this code.
Label emit_address(Assembler& c, const Instruction* at, unsigned size, Label& other) {
  const auto mode = traits_of(at->op).mode;
  MEBOTS_ASSERT(size == 1 || size == 2 || size == 4);
  const auto imm = mode == AddressMode::offset ? static_cast<std::uint32_t>(at->imm) : 0U;
  const auto distance = imm - c.ram[0].base;
  if (at->rs1 == 0) {
    c.mov(eax, distance);
  } else {
    const auto base = c.registers.value(at->rs1, eax);
    c.lea(eax, ptr[base.cvt64() + static_cast<std::int32_t>(distance)]);
  }
  if (const auto step = step_register(at); mode == AddressMode::offset_register && step != 0)
    c.add(eax, c.registers.source(step, ecx));
  Label inside;
  check_address(c, eax, ecx, c.ram[0], size, other);
  c.L(inside);
  return inside;
}

/// Writes code for the case that the address check failed. A halfword in the middle of a word needs only one access, so
/// the code jumps to `inside`.
void emit_middle_of_word(Assembler& c, unsigned size, Label& inside) {
  if (size != 2) return;
  Label other;
  c.mov(ecx, eax);
  c.and_(ecx, 3);
  c.cmp(ecx, 1);
  c.jne(other);
  c.cmp(eax, c.ram[0].span);
  c.jb(inside, kNear);
  c.L(other);
}

/// Writes code for an access to two words. A store jumps to `marked` if one of the words is marked. Writes no code for
/// a load that is one of the last two instructions of a block. Such a load may change the cycles of the next block, so
/// the interpreter executes it.
void emit_across_words(Assembler& c, const Instruction* at, unsigned size, Label& marked, Label& claimed) {
  if (size == 1 || (is_load(at->op) && (is_block_end(at[1].op) || is_block_end(at[2].op)))) return;
  Label other;
  c.cmp(eax, c.ram[0].span);
  c.jae(other, kNear);
  if (is_store(at->op)) {
    c.mov(ecx, eax);
    c.shr(ecx, 2);
    c.cmp(c.marks_of_word(2), 0);
    c.jne(marked, kNear);
  } else {
    c.mov(rdx, reinterpret_cast<std::uint64_t>(at));
    c.mov(ptr[rbx + static_cast<int>(offsetof(Execution, host.slow_load))], rdx);
    c.movq(ptr[rbx + static_cast<int>(offsetof(Execution, host.slow_load_when))], xmm15);
  }
  c.cycles.claim_bank(at, false);
  c.cycles.spend(kMisalignedExtra + c.ram[0].wait_cycles);
  if (c.options.banks != nullptr) {
    c.add(eax, 4);
    c.cycles.claim_bank(at, false);
    c.sub(eax, 4);
  }
  c.jmp(claimed, kNear);
  c.L(other);
}

/// Writes code that adds the increment of a post-increment to the address register. The code changes ecx and edx.
void emit_increment(Assembler& c, const Instruction* at) {
  const auto mode = traits_of(at->op).mode;
  // If a load writes its own address register, the loaded value replaces the incremented address.
  if (at->rs1 == 0 || (is_load(at->op) && at->rd == at->rs1)) return;
  const auto add_to = [&c, at, mode](const Xbyak::Operand& to) {
    if (mode == AddressMode::post_immediate) {
      c.add(to, static_cast<std::uint32_t>(at->imm));
    } else if (mode == AddressMode::post_register && step_register(at) != 0) {
      c.add(to, c.registers.value(step_register(at), edx));
    }
  };
  if (!c.registers.in_vector(at->rs1)) {
    add_to(c.registers.operand(at->rs1));
  } else if (is_post_increment(at->op)) {
    c.registers.copy(ecx, at->rs1);
    add_to(ecx);
    c.registers.finish(at->rs1, ecx);
  }
}

void emit_read(Assembler& c, const Reg32& to, const Xbyak::RegExp& from, unsigned size, bool sign) {
  if (size == 4) {
    c.mov(to, dword[from]);
  } else if (size == 2) {
    sign ? c.movsx(to, word[from]) : c.movzx(to, word[from]);
  } else {
    sign ? c.movsx(to, byte[from]) : c.movzx(to, byte[from]);
  }
}

/// Writes code that counts an access to the second memory, and the cycles that the access waits. The offset in the
/// memory must be in ecx. The code changes eax and edx. If the interpreter must perform the access, the code only jumps
/// to `left`.
void emit_far_wait(Assembler& c, const Instruction* at, Label& left) {
  const auto& ram = c.ram[1];
  if (ram.is_shared()) {
    MEBOTS_ASSERT(c.stubs.far != nullptr);
    c.mov(edx, at->cycles_before);
    c.call(c.stubs.far);
    c.test(eax, eax);
    c.js(left, kNear);
    return;
  }
  c.inc(qword[rbx + static_cast<int>(offsetof(Execution, counters.far_accesses))]);
  if (ram.wait_cycles != c.ram[0].wait_cycles) c.cycles.spend(ram.wait_cycles - c.ram[0].wait_cycles);
}

/// Writes code that loads from a device at the address `ram[0].base + eax` with Bus::load_quietly(), and then jumps to
/// `done`. If load_quietly() cannot perform the load, the code has no effect, and the interpreter performs the load.
/// `take(from)` must write code that moves the value at `from` to its destination.
template <typename Take>
void emit_quiet_load(Assembler& c, const Instruction* at, unsigned size, const Block& block, Take take, Label& done) {
  if (c.stubs.device == nullptr) return;
  Label rare;
  Label too_late;
  c.cycles.jump_if_stalled(at, block.stalled_by, rare);
  c.fetches.undo_after(at);  // the device needs the cycle of this instruction
  c.lea(ecx, ptr[rax + static_cast<std::int32_t>(c.ram[0].base)]);
  c.mov(edx, at->cycles_before + c.cycles.waits_before(at));
  c.mov(eax, size);
  c.call(c.stubs.device);
  c.test(rax, rax);
  c.js(rare);
  // If the rest of the block might reach the limit, the interpreter performs the load.
  c.sub(r15, rax);
  c.cmp(r15, c.blocks.fetch_bound(block));
  c.jle(too_late);
  // The code at the end of the block counts the wait cycles of the first memory for this load. A load from a device has
  // none of them, so they are taken back here.
  if (c.ram[0].wait_cycles != 0) c.add(r15, c.ram[0].wait_cycles);
  c.inc(qword[rbx + static_cast<int>(offsetof(Execution, counters.device_accesses))]);
  c.fetches.repeat_after(at);
  take(rbx + translate::offset_of_host(offsetof(HostState, loaded)));
  c.jmp(done, kNear);
  c.L(too_late);
  c.add(r15, rax);
  c.L(rare);
}

}  // namespace

bool emit_load(Assembler& c, const Instruction* at) {
  if (c.ram[0].span == 0) return false;
  const unsigned size = traits_of(at->op).size;
  const bool sign = traits_of(at->op).sign;
  Label other;
  Label claimed;
  Label done;
  auto inside = emit_address(c, at, size, other);
  c.cycles.claim_bank(at, size == 4);
  c.L(claimed);
  // A post-increment reads its increment after the load. If the load writes the register that contains the increment,
  // the old value is needed until then.
  const bool is_own_step = traits_of(at->op).mode == AddressMode::post_register && step_register(at) == at->rd;
  const auto to = c.registers.place(at->rd, eax, is_own_step);
  const bool into_vector = size == 4 && c.registers.in_vector(at->rd) && !is_own_step;
  const auto take = [&c, at, size, sign, to, into_vector](const Xbyak::RegExp& from) {
    if (into_vector) {
      c.movd(c.registers.vector(at->rd), dword[from]);
    } else {
      emit_read(c, to, from, size, sign);
    }
  };
  take(r14 + rax);
  c.L(done);
  emit_increment(c, at);
  if (!into_vector) c.registers.finish(at->rd, to);
  const auto& block = c.edges.block();
  c.defer_cold([&c, &block, at, size, take, other, claimed, done, inside]() mutable {
    c.L(other);
    emit_middle_of_word(c, size, inside);
    emit_across_words(c, at, size, claimed, claimed);
    const auto& ram = c.ram[1];
    if (ram.span == 0) {
      emit_quiet_load(c, at, size, block, take, done);
      c.edges.resume(at);
      return;
    }
    Label neither;
    c.lea(ecx, ptr[rax + static_cast<std::int32_t>(c.ram[0].base - ram.base)]);
    check_address(c, ecx, edx, ram, size, neither);
    emit_far_wait(c, at, neither);
    c.mov(rdx, reinterpret_cast<std::uint64_t>(ram.data));
    take(rdx + rcx);
    c.jmp(done, kNear);
    c.L(neither);
    emit_quiet_load(c, at, size, block, take, done);
    c.edges.resume(at);
  });
  return true;
}

bool emit_store(Assembler& c, const Instruction* at) {
  if (c.ram[0].span == 0) return false;
  const unsigned size = traits_of(at->op).size;
  Label other;
  Label marked;
  Label claimed;
  Label done;
  const auto store = [&c, at, size](const Xbyak::RegExp& where, const Reg32& scratch) {
    const auto from = c.registers.value(at->rs2, scratch);
    if (size == 4) {
      c.mov(dword[where], from);
    } else if (size == 2) {
      c.mov(word[where], from.cvt16());
    } else {
      c.mov(byte[where], from.cvt8());
    }
  };
  auto inside = emit_address(c, at, size, other);
  if (size != 4) {
    c.mov(ecx, eax);
    c.shr(ecx, 2);
  }
  c.cmp(c.marks_of_word(1), 0);
  c.jne(marked, kNear);
  c.cycles.claim_bank(at, true);
  c.L(claimed);
  store(r14 + rax, ecx);
  c.L(done);
  emit_increment(c, at);
  c.defer_cold([&c, at, size, store, other, marked, claimed, done, inside]() mutable {
    c.L(other);
    emit_middle_of_word(c, size, inside);
    emit_across_words(c, at, size, marked, claimed);
    const auto& ram = c.ram[1];
    if (ram.span != 0) {
      c.lea(ecx, ptr[rax + static_cast<std::int32_t>(c.ram[0].base - ram.base)]);
      check_address(c, ecx, edx, ram, size, marked);
      c.mov(eax, ecx);
      c.shr(eax, 2);
      c.mov(rdx, reinterpret_cast<std::uint64_t>(ram.marks));
      c.cmp(byte[rdx + rax], 0);
      c.jne(marked, kNear);
      emit_far_wait(c, at, marked);
      c.mov(rdx, reinterpret_cast<std::uint64_t>(ram.data));
      store(rdx + rcx, eax);
      c.jmp(done, kNear);
    }
    c.L(marked);
    c.edges.resume(at);
  });
  return true;
}

}  // namespace mebots::soc
#endif
