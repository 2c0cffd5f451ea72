// SPDX-License-Identifier: Apache-2.0
// Error messages that explain why a core cannot continue.
#include "hart/csr_numbers.hpp"
#include "hart/extensions.hpp"
#include "isa/encoding.hpp"
#include "soc/backtrace.hpp"
#include "soc/soc.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace mebots::soc {
namespace {

std::string_view cause_text(std::uint32_t cause) {
  if ((cause & cause::kInterrupt) != 0) return "interrupt";
  switch (cause) {
    case cause::kFetchAccess:
      return "instruction access fault";
    case cause::kIllegalInstruction:
      return "illegal instruction";
    case cause::kBreakpoint:
      return "ebreak";
    case cause::kLoadAccess:
      return "load access fault";
    case cause::kStoreAccess:
      return "store access fault";
    case cause::kUserEcall:
    case cause::kMachineEcall:
      return "ecall";
    case cause::kLoadMisaligned:
    case cause::kStoreMisaligned:
      return "misaligned atomic operation";
    default:
      return "trap";
  }
}

std::string place_text(const Elf& program, std::uint32_t pc) {
  const auto function = program.where(pc);
  return fmt::format("pc 0x{:08x} in {}", pc, function.empty() ? "no function of the program" : function);
}

bool is_access_fault(std::uint32_t cause) {
  return cause == cause::kFetchAccess || cause == cause::kLoadAccess || cause == cause::kStoreAccess;
}

std::uint32_t access_size(const Exception& what, const BlockCache& blocks) {
  if (what.cause == cause::kFetchAccess) return 2;
  return std::max<std::uint32_t>(traits_of(blocks.decode_word(what.instruction).op).size, 1);
}

/// Returns the reason why a core could not access an address that a memory contains.
std::string memory_text(const Region& region, std::uint32_t address, std::uint32_t size, const Timing& timing) {
  if (!region.holds(address, size)) {
    return fmt::format("the {} bytes from 0x{:08x} on do not all lie in memory {}, which ends at 0x{:08x}", size,
                       address, region.name, region.base + (region.size - 1));
  }
  const auto place = fmt::format("0x{:08x} lies in memory {}", address, region.name);
  if (timing.pmp_entries == 0) return fmt::format("{}, to which this core has no access", place);
  return fmt::format("{}: physical memory protection (pmpcfg, pmpaddr) forbids this access", place);
}

/// Returns a text about the address of an access fault: what the board has there, or lacks.
std::string address_text(const Exception& what, const Soc& soc, const BlockCache& blocks) {
  const auto address = what.value;
  const auto& board = soc.board();
  const auto absence = std::ranges::find_if(
      board.absent, [address](const BoardAbsence& range) { return address - range.base < range.size; });
  if (absence != board.absent.end()) {
    return fmt::format("0x{:08x} is {}, which board {} lacks{}{}", address, absence->name, board.name,
                       absence->text.empty() ? "" : ": ", absence->text);
  }
  if (const auto* slot = soc.devices().slot_at(address)) {
    return fmt::format("device {} has no register for this access at its offset 0x{:x}", slot->name,
                       address - slot->base);
  }
  if (const auto* region = soc.memory().find(address, 1); region != nullptr) {
    return memory_text(*region, address, access_size(what, blocks), blocks.timing());
  }
  std::string memories;
  for (const auto& region : soc.memory().regions()) {
    memories += fmt::format("{}0x{:08x} to 0x{:08x}", memories.empty() ? "" : ", ", region.base,
                            region.base + (region.size - 1));
  }
  return fmt::format("board {} has nothing at 0x{:08x}; its memories are {}", board.name, address, memories);
}

std::string text_of(const Exception& what, const Soc& soc, const Hart& hart) {
  const auto& program = soc.program();
  auto text =
      fmt::format("{} (mcause {}, mtval 0x{:08x}) at {}: {}", cause_text(what.cause), what.cause, what.value,
                  place_text(program, what.pc),
                  what.instruction == 0 ? "no instruction there"
                                        : disassemble(what.instruction, what.pc, hart.code().blocks.extensions()));
  if (is_access_fault(what.cause)) return fmt::format("{}; {}", text, address_text(what, soc, hart.code().blocks));
  if (what.cause != cause::kIllegalInstruction) return text;
  const auto advice = advice_for_illegal(what.instruction, hart.code().blocks.extensions(), program.architecture());
  return advice.empty() ? text : fmt::format("{}; {}", text, advice);
}

/// Returns a text about the stack: whether it is outside all memories, and the callers found on it.
std::string stack_text(const Exception& what, const Elf& program, const Memory& memory) {
  std::string text;
  if (what.stack_pointer != 0 && memory.find(what.stack_pointer & ~3U, 4) == nullptr) {
    text = fmt::format("; the stack pointer 0x{:08x} is outside the memory", what.stack_pointer);
  }
  const auto callers = debug::backtrace(program, memory, what.return_address, what.stack_pointer);
  return callers.empty() ? text : fmt::format("{}; called from {}", text, callers);
}

}  // namespace

std::optional<int> Soc::gave_up() const {
  if (end() != End::exited || exit_code() == 0) return std::nullopt;
  const auto& ender = hart(hart_of_core(timeline_.ended_by()));
  const auto cause = ender.fault().first.cause;
  if (!ender.in_exception() || cause == cause::kUserEcall || cause == cause::kMachineEcall) return std::nullopt;
  return timeline_.ended_by();
}

std::string Soc::unfinished_exception_text() const {
  if (!hart().in_exception()) return {};
  const auto& first = hart().fault().first;
  return text_of(first, *this, hart()) + stack_text(first, program_, memory());
}

std::string Soc::fault_text() const {
  const auto giver = gave_up();
  const int core = giver ? *giver : cluster() != nullptr ? cluster()->faulted_core() : kFabricControllerCore;
  const auto& ender = hart(hart_of_core(core));
  const auto& fault = ender.fault();
  if (!giver && !fault.happened) return {};
  const auto whose = core == kFabricControllerCore ? "" : fmt::format("cluster core {}: ", core);
  if (giver) {
    return fmt::format("{}the program's own handler ended the program with exit code {}, after {}{}", whose,
                       exit_code(), text_of(fault.first, *this, ender), stack_text(fault.first, program_, memory()));
  }
  auto text = fmt::format("{}{}: {}", whose,
                          fault.double_trap ? "an exception in its own trap handler" : "trap without a handler",
                          text_of(fault.last, *this, ender));
  if (fault.double_trap && fault.first.pc != fault.last.pc) {
    text += fmt::format("; it began with {} (mtval 0x{:08x}) at {}", cause_text(fault.first.cause), fault.first.value,
                        place_text(program_, fault.first.pc));
  }
  return text + stack_text(fault.last, program_, memory());
}

}  // namespace mebots::soc
