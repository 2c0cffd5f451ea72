// SPDX-License-Identifier: Apache-2.0
#include "hart/extensions.hpp"

#include "hart/csr_numbers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace mebots::soc {
namespace {

struct Row {
  std::uint32_t mask;
  std::uint32_t match;
  ForeignInstruction instruction;
};

constexpr std::uint32_t kOpcode = 0x7f;
constexpr std::uint32_t kFunct3 = 0x707f;
constexpr std::uint32_t kFunct5 = 0xf800707f;  // funct5 of the A extension, funct3 and opcode
constexpr std::uint32_t kTop6 = 0xfc00707f;
constexpr std::uint32_t kFunct7 = 0xfe00707f;
constexpr std::uint32_t kFunct12 = 0xfff0707f;
constexpr std::uint32_t kFormat = 0x0600007f;  // format of a floating-point operation, and opcode
constexpr std::uint32_t kCompressed = 0xe003;  // quadrant and funct3
constexpr std::uint32_t kAll = 0xffffffff;

constexpr std::uint32_t amo(std::uint32_t funct5) {
  return funct5 << 27 | 2U << 12 | 0x2fU;
}
constexpr std::uint32_t op(std::uint32_t opcode, std::uint32_t funct3, std::uint32_t funct7 = 0) {
  return opcode | funct3 << 12 | funct7 << 25;
}

constexpr std::uint32_t kImmediate = 0x13;
constexpr std::uint32_t kRegister = 0x33;
constexpr std::uint32_t kSystem = 0x73;

/// If a word matches several rows, the first of these rows applies.
constexpr auto kRows = std::to_array<Row>({
    // Atomic memory operations.
    {kFunct5, amo(0x00), {"amoadd.w", "A"}},
    {kFunct5, amo(0x01), {"amoswap.w", "A"}},
    {kFunct5, amo(0x02), {"lr.w", "A"}},
    {kFunct5, amo(0x03), {"sc.w", "A"}},
    {kFunct5, amo(0x04), {"amoxor.w", "A"}},
    {kFunct5, amo(0x08), {"amoor.w", "A"}},
    {kFunct5, amo(0x0c), {"amoand.w", "A"}},
    {kFunct5, amo(0x10), {"amomin.w", "A"}},
    {kFunct5, amo(0x14), {"amomax.w", "A"}},
    {kFunct5, amo(0x18), {"amominu.w", "A"}},
    {kFunct5, amo(0x1c), {"amomaxu.w", "A"}},
    {kFunct5, amo(0x05), {"amocas.w", "Zacas"}},
    {kFunct3, op(0x2f, 0), {"a byte-wide atomic operation", "Zabha"}},
    {kFunct3, op(0x2f, 1), {"a halfword-wide atomic operation", "Zabha"}},
    {kFunct3, op(0x2f, 3), {"a doubleword-wide atomic operation", "RV64A"}},
    // Floating point
    {kFunct3, op(0x07, 2), {"flw", "F"}},
    {kFunct3, op(0x07, 3), {"fld", "D"}},
    {kFunct3, op(0x07, 1), {"flh", "Zfh"}},
    {kFunct3, op(0x07, 4), {"flq", "Q"}},
    {kFunct3, op(0x27, 2), {"fsw", "F"}},
    {kFunct3, op(0x27, 3), {"fsd", "D"}},
    {kFunct3, op(0x27, 1), {"fsh", "Zfh"}},
    {kFunct3, op(0x27, 4), {"fsq", "Q"}},
    {kFormat, 0x00000053, {"a single-precision operation", "F"}},
    {kFormat, 0x02000053, {"a double-precision operation", "D"}},
    {kFormat, 0x04000053, {"a half-precision operation", "Zfh"}},
    {kFormat, 0x06000053, {"a quad-precision operation", "Q"}},
    {kFormat, 0x00000043, {"fmadd.s", "F"}},
    {kFormat, 0x02000043, {"fmadd.d", "D"}},
    {kFormat, 0x00000047, {"fmsub.s", "F"}},
    {kFormat, 0x02000047, {"fmsub.d", "D"}},
    {kFormat, 0x0000004b, {"fnmsub.s", "F"}},
    {kFormat, 0x0200004b, {"fnmsub.d", "D"}},
    {kFormat, 0x0000004f, {"fnmadd.s", "F"}},
    {kFormat, 0x0200004f, {"fnmadd.d", "D"}},
    {kCompressed, 0x6000, {"c.flw", "F"}},
    {kCompressed, 0xe000, {"c.fsw", "F"}},
    {kCompressed, 0x6002, {"c.flwsp", "F"}},
    {kCompressed, 0xe002, {"c.fswsp", "F"}},
    {kCompressed, 0x2000, {"c.fld", "D"}},
    {kCompressed, 0xa000, {"c.fsd", "D"}},
    {kCompressed, 0x2002, {"c.fldsp", "D"}},
    {kCompressed, 0xa002, {"c.fsdsp, or cm.push and cm.pop", "D, or Zcmp"}},
    {kCompressed, 0x8000, {"a byte or halfword access of 16 bits", "Zcb"}},
    // Vectors
    {kFunct3, op(0x57, 7), {"vsetvli", "V"}},
    {kOpcode, 0x57, {"a vector operation", "V"}},
    {kOpcode, 0x07, {"a vector load", "V"}},
    {kOpcode, 0x27, {"a vector store", "V"}},
    // 64 bits
    {kFunct3, op(0x03, 3), {"ld", "RV64I"}},
    {kFunct3, op(0x03, 6), {"lwu", "RV64I"}},
    {kFunct3, op(0x23, 3), {"sd", "RV64I"}},
    {kOpcode, 0x1b, {"a word-wide operation", "RV64I"}},
    {kOpcode, 0x3b, {"a word-wide operation", "RV64I"}},
    // Bit manipulation
    {kFunct7, op(kRegister, 2, 0x10), {"sh1add", "Zba"}},
    {kFunct7, op(kRegister, 4, 0x10), {"sh2add", "Zba"}},
    {kFunct7, op(kRegister, 6, 0x10), {"sh3add", "Zba"}},
    {kFunct7, op(kRegister, 7, 0x20), {"andn", "Zbb"}},
    {kFunct7, op(kRegister, 6, 0x20), {"orn", "Zbb"}},
    {kFunct7, op(kRegister, 4, 0x20), {"xnor", "Zbb"}},
    {kFunct7, op(kRegister, 4, 0x05), {"min", "Zbb"}},
    {kFunct7, op(kRegister, 5, 0x05), {"minu", "Zbb"}},
    {kFunct7, op(kRegister, 6, 0x05), {"max", "Zbb"}},
    {kFunct7, op(kRegister, 7, 0x05), {"maxu", "Zbb"}},
    {kFunct7, op(kRegister, 1, 0x30), {"rol", "Zbb"}},
    {kFunct7, op(kRegister, 5, 0x30), {"ror", "Zbb"}},
    {kFunct7, op(kImmediate, 5, 0x30), {"rori", "Zbb"}},
    {kFunct12, 0x60001013, {"clz", "Zbb"}},
    {kFunct12, 0x60101013, {"ctz", "Zbb"}},
    {kFunct12, 0x60201013, {"cpop", "Zbb"}},
    {kFunct12, 0x60401013, {"sext.b", "Zbb"}},
    {kFunct12, 0x60501013, {"sext.h", "Zbb"}},
    {kFunct12, 0x08004033, {"zext.h", "Zbb"}},
    {kFunct12, 0x28705013, {"orc.b", "Zbb"}},
    {kFunct12, 0x69805013, {"rev8", "Zbb"}},
    {kFunct12, 0x68705013, {"brev8", "Zbkb"}},
    {kFunct7, op(kRegister, 4, 0x04), {"pack", "Zbkb"}},
    {kFunct7, op(kRegister, 7, 0x04), {"packh", "Zbkb"}},
    {kFunct7, op(kRegister, 1, 0x05), {"clmul", "Zbc"}},
    {kFunct7, op(kRegister, 2, 0x05), {"clmulr", "Zbc"}},
    {kFunct7, op(kRegister, 3, 0x05), {"clmulh", "Zbc"}},
    {kFunct7, op(kRegister, 1, 0x14), {"bset", "Zbs"}},
    {kFunct7, op(kRegister, 1, 0x24), {"bclr", "Zbs"}},
    {kFunct7, op(kRegister, 5, 0x24), {"bext", "Zbs"}},
    {kFunct7, op(kRegister, 1, 0x34), {"binv", "Zbs"}},
    {kFunct7, op(kImmediate, 1, 0x14), {"bseti", "Zbs"}},
    {kFunct7, op(kImmediate, 1, 0x24), {"bclri", "Zbs"}},
    {kFunct7, op(kImmediate, 5, 0x24), {"bexti", "Zbs"}},
    {kFunct7, op(kImmediate, 1, 0x34), {"binvi", "Zbs"}},
    {kFunct7, op(kRegister, 5, 0x07), {"czero.eqz", "Zicond"}},
    {kFunct7, op(kRegister, 7, 0x07), {"czero.nez", "Zicond"}},
    {kTop6, op(kImmediate, 1, 0x08), {"a hash operation", "Zknh"}},
    // Instructions for cache management and privileged modes.
    {kFunct3, op(0x0f, 2), {"a cache-block operation", "Zicbom or Zicboz"}},
    {kAll, 0x10200073, {"sret", "S"}},
    {kAll, 0x00200073, {"uret", "N"}},
    {kAll, 0x7b200073, {"dret", "the debug mode"}},
    {kAll, 0x70200073, {"mnret", "Smrnmi"}},
    {kAll, 0x00d00073, {"wrs.nto", "Zawrs"}},
    {kAll, 0x01d00073, {"wrs.sto", "Zawrs"}},
    {0xfe007fff, 0x12000073, {"sfence.vma", "S"}},
    {0xfe007fff, 0x22000073, {"hfence.vvma", "H"}},
    {0xfe007fff, 0x62000073, {"hfence.gvma", "H"}},
    {kFunct3, op(kSystem, 4), {"a load or store of a hypervisor", "H"}},
});

struct RegisterGroup {
  unsigned first;
  unsigned last;
  std::string_view extension;
};

/// Control and status registers that a core may lack, and the extensions to which they belong.
constexpr auto kRegisterGroups = std::to_array<RegisterGroup>({
    {0x001, 0x003, "F"},
    {0x008, 0x00f, "V"},
    {0xc20, 0xc22, "V"},
    {0x015, 0x015, "Zkr"},
    {0x017, 0x017, "Zcmt"},
    {0x100, 0x1ff, "S"},
    {0x200, 0x2ff, "H"},
    {0x302, 0x303, "S"},
    {0x306, 0x306, "U"},
    {0x30a, 0x30a, "U"},
    {0x310, 0x310, "big-endian mode (mstatush)"},
    {0x31a, 0x31a, "U"},
    {0x3a0, 0x3ef, "physical memory protection (PMP)"},
    {0x600, 0x6ff, "H"},
    {0x747, 0x747, "Smepmp"},
    {0x757, 0x757, "Smepmp"},
    {0x740, 0x744, "Smrnmi"},
    {0x7a0, 0x7af, "triggers"},
    {0x7b0, 0x7b3, "the debug mode"},
    {0xc01, 0xc01, "Zicntr's time"},
    {0xc81, 0xc81, "Zicntr's time"},
});

bool is_csr_access(std::uint32_t word) {
  return (word & kOpcode) == kSystem && (word >> 12 & 3U) != 0;
}

std::string register_advice(unsigned number) {
  const auto group = std::ranges::find_if(
      kRegisterGroups, [number](const RegisterGroup& row) { return number >= row.first && number <= row.last; });
  auto text = fmt::format("the core has no register {} (0x{:03x}), or it cannot be written", csr::name(number), number);
  if (group == kRegisterGroups.end()) return text;
  return fmt::format("{}; it belongs to {}", text, group->extension);
}

/// Returns the compiler options for a core with these extensions.
std::string_view option_for(Extensions has) {
  return has.has(Extension::xpulp) ? "-march=rv32imcxpulpv2 (PULP's compiler), or -march=rv32imc_zicsr"
                                   : "-march=rv32imc_zicsr";
}

}  // namespace

ForeignInstruction foreign_instruction(std::uint32_t word) {
  for (const auto& row : kRows) {
    if ((word & row.mask) == row.match) return row.instruction;
  }
  return {};
}

std::string advice_for_illegal(std::uint32_t word, Extensions has, std::string_view architecture) {
  if ((word & 0xffffU) == 0) return "the word is 0, which is no instruction: there is no code here";
  if (word == kAll) return "the word is all ones, which is no instruction: erased flash, or no code here";
  if (is_csr_access(word)) return register_advice(word >> 20);
  const auto foreign = foreign_instruction(word);
  const bool is_xpulp = !has.has(Extension::xpulp) && decode(word, Extension::xpulp).encoding != nullptr;
  if (is_xpulp && foreign.name.empty()) {
    return "this is an instruction of Xpulp v2: run it on a core ri5cy, or compile with -march=rv32imc_zicsr";
  }
  if (foreign.name.empty()) return {};
  const auto or_xpulp = is_xpulp ? ", or an instruction of Xpulp v2 for a core ri5cy" : "";
  const auto built =
      architecture.empty() ? std::string() : fmt::format("; the program was compiled for {}", architecture);
  // The ISA string sets the extensions of a generic core. The key `isa` of the board file sets those of a board's core.
  const auto option = optional_extension(foreign.extension);
  if (decode(word, has).encoding != nullptr) {
    return "this instruction is not allowed now: it is a floating-point operation while mstatus.FS is Off or with an "
           "invalid rounding mode, or it is an instruction of machine mode in U mode";
  }
  const auto with_it =
      option == Extension::standard || has.has(option)
          ? std::string()
          : fmt::format(", or give the core the extension: \"isa\": \"{0}\" on a board, --core {0} without one",
                        isa_string(has.with(option)));
  return fmt::format("this is {}, of extension {}{}, which the core lacks{}: compile with {} -mabi=ilp32{}",
                     foreign.name, foreign.extension, or_xpulp, built, option_for(has), with_it);
}

}  // namespace mebots::soc
