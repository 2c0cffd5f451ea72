// SPDX-License-Identifier: Apache-2.0
#include "observe/trace.hpp"

#include "hart/csr_numbers.hpp"

#include <string_view>

namespace mebots::soc::observe {
namespace {

bool writes_register(const Decoded& decoded) {
  return decoded.rd != 0 && !is_branch(decoded.op) && !is_store(decoded.op) && decoded.op != Op::fence &&
         decoded.op != Op::fence_i && decoded.op != Op::wfi && decoded.op != Op::mret && !is_hardware_loop(decoded.op);
}

bool writes_csr(const Decoded& decoded) {
  return decoded.op == Op::csrrw || decoded.op == Op::csrrwi || (is_csr(decoded.op) && decoded.rs1 != 0);
}

}  // namespace

Trace::Trace(const std::string& option, const std::string& path, Columns columns, unsigned harts)
    : columns_(columns), file_(option, path) {
  for (unsigned number = 0; number < harts; ++number) harts_.emplace_back(*this, number);
}

void Trace::put(unsigned number, const Hart& hart, const Retired& instruction) {
  const auto& decoded = instruction.decoded;
  const auto& access = instruction.access;
  // Only mret changes the privilege mode. Any other instruction was executed in the mode that the hart has afterwards.
  const auto mode = static_cast<unsigned>(decoded.op == Op::mret ? Mode::machine : hart.mode());
  if (decoded.length == 2) {
    file_.print("core{:4}: {} 0x{:08x} (0x{:04x})", number, mode, instruction.pc, instruction.word & 0xffffU);
  } else {
    file_.print("core{:4}: {} 0x{:08x} (0x{:08x})", number, mode, instruction.pc, instruction.word);
  }
  if (writes_register(decoded)) {
    const bool is_float = decoded.rd >= kFirstFloat;
    file_.print(" {}{:<2} 0x{:08x}", is_float ? 'f' : 'x', decoded.rd % kFirstFloat, hart.reg(decoded.rd));
  }
  if (is_post_increment(decoded.op)) file_.print(" x{:<2} 0x{:08x}", decoded.rs1, hart.reg(decoded.rs1));
  if (writes_csr(decoded)) {
    const auto index = static_cast<unsigned>(decoded.imm);
    std::uint32_t value = 0;
    hart.csr(index, value);
    file_.print(" c{}_{} 0x{:08x}", index, csr::name(index), value);
  }
  if (decoded.op == Op::mret) {
    std::uint32_t value = 0;
    hart.csr(csr::kMstatus, value);
    file_.print(" c{}_{} 0x{:08x}", csr::kMstatus, csr::name(csr::kMstatus), value);
  }
  if (access.size != 0) file_.print(" mem 0x{:08x}", access.address);
  if (access.store) {
    const auto value = instruction.stored;
    if (access.size == 1) file_.print(" 0x{:02x}", value & 0xffU);
    if (access.size == 2) file_.print(" 0x{:04x}", value & 0xffffU);
    if (access.size == 4) file_.print(" 0x{:08x}", value);
  }
  if (columns_.cycles) file_.print(" # {}", hart.counters().cycles);
  file_.put("\n");
}

}  // namespace mebots::soc::observe
