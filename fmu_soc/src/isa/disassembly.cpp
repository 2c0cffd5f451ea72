// SPDX-License-Identifier: Apache-2.0
#include "isa/encoding.hpp"

#include <fmt/core.h>

#include <array>

namespace mebots::soc {
namespace {

constexpr std::array<std::string_view, 32> kNames{"zero", "ra", "sp", "gp", "tp",  "t0",  "t1", "t2", "s0", "s1", "a0",
                                                  "a1",   "a2", "a3", "a4", "a5",  "a6",  "a7", "s2", "s3", "s4", "s5",
                                                  "s6",   "s7", "s8", "s9", "s10", "s11", "t3", "t4", "t5", "t6"};

std::string operands(const Decoded& d, std::uint32_t pc) {
  const auto rd = kNames[d.rd];
  const auto rs1 = kNames[d.rs1];
  const auto rs2 = kNames[d.rs2];
  const auto target = pc + static_cast<std::uint32_t>(d.imm);
  const auto upper = static_cast<std::uint32_t>(d.imm) >> 12;
  switch (d.encoding->format) {
    case Format::none:
    case Format::c_none:
    case Format::fence:
      return {};
    case Format::r:
    case Format::simd:
    case Format::simd_scalar:
      return fmt::format(" {}, {}, {}", rd, rs1, rs2);
    case Format::unary:
      return fmt::format(" {}, {}", rd, rs1);
    case Format::load_reg:
      return fmt::format(" {}, {}({})", rd, rs2, rs1);
    case Format::load_post:
      return fmt::format(" {}, {}({}!)", rd, d.imm, rs1);
    case Format::load_post_reg:
      return fmt::format(" {}, {}({}!)", rd, rs2, rs1);
    case Format::store_reg:
      return fmt::format(" {}, {}({})", rs2, kNames[d.rs3], rs1);
    case Format::store_post:
      return fmt::format(" {}, {}({}!)", rs2, d.imm, rs1);
    case Format::store_post_reg:
      return fmt::format(" {}, {}({}!)", rs2, kNames[d.rs3], rs1);
    case Format::branch_imm:
      return fmt::format(" {}, {}, 0x{:08x}", rs1, d.rs2 < 16 ? d.rs2 : d.rs2 - 32, target);
    case Format::loop_target:
      return fmt::format(" x{}, 0x{:08x}", d.rs2, target);
    case Format::loop_count:
      return fmt::format(" x{}, {}", d.rs2, rs1);
    case Format::loop_counti:
      return fmt::format(" x{}, {}", d.rs2, d.imm);
    case Format::loop_setup:
      return fmt::format(" x{}, {}, 0x{:08x}", d.rs2, rs1, target);
    case Format::loop_setupi:
      return fmt::format(" x{}, {}, 0x{:08x}", d.rs2, d.imm & 0xffff, pc + (static_cast<std::uint32_t>(d.imm) >> 16));
    case Format::bit_field:
      return fmt::format(" {}, {}, {}, {}", rd, rs1, d.imm >> 5, d.imm & 31);
    case Format::shifted:
    case Format::shifted_some:
      return fmt::format(" {}, {}, {}, {}", rd, rs1, rs2, d.imm);
    case Format::shuffle_b:
      return fmt::format(" {}, {}, {}", rd, rs1, d.imm & 63);
    case Format::clip:
    case Format::simd_imm:
    case Format::simd_uimm:
    case Format::simd_lane:
    case Format::shuffle_h:
    case Format::i:
    case Format::shift:
      return fmt::format(" {}, {}, {}", rd, rs1, d.imm);
    case Format::load:
    case Format::jalr:
    case Format::c_load:
    case Format::c_lwsp:
      return fmt::format(" {}, {}({})", rd, d.imm, rs1);
    case Format::store:
    case Format::c_store:
    case Format::c_swsp:
      return fmt::format(" {}, {}({})", rs2, d.imm, rs1);
    case Format::branch:
      return fmt::format(" {}, {}, 0x{:08x}", rs1, rs2, target);
    case Format::u:
    case Format::c_lui:
      return fmt::format(" {}, 0x{:x}", rd, upper);
    case Format::jal:
      return fmt::format(" {}, 0x{:08x}", rd, target);
    case Format::csr:
      return fmt::format(" {}, 0x{:x}, {}", rd, d.imm, rs1);
    case Format::csr_imm:
      return fmt::format(" {}, 0x{:x}, {}", rd, d.imm, d.rs1);
    case Format::c_addi4spn:
      return fmt::format(" {}, sp, {}", rd, d.imm);
    case Format::c_addi:
    case Format::c_li:
    case Format::c_shift:
    case Format::c_andi:
    case Format::c_slli:
      return fmt::format(" {}, {}", rd, d.imm);
    case Format::c_addi16sp:
      return fmt::format(" sp, {}", d.imm);
    case Format::c_jump:
    case Format::c_jal:
      return fmt::format(" 0x{:08x}", target);
    case Format::c_alu:
    case Format::c_mv:
    case Format::c_add:
      return fmt::format(" {}, {}", rd, rs2);
    case Format::c_branch:
      return fmt::format(" {}, 0x{:08x}", rs1, target);
    case Format::c_jr:
    case Format::c_jalr:
      return fmt::format(" {}", rs1);
  }
  return {};
}

}  // namespace

std::string_view register_name(unsigned index) {
  return kNames[index];
}

std::string disassemble(std::uint32_t word, std::uint32_t pc) {
  const auto decoded = decode(word);
  if (decoded.op == Op::illegal) {
    return decoded.length == 2 ? fmt::format(".half 0x{:04x}", word & 0xffffU) : fmt::format(".word 0x{:08x}", word);
  }
  return fmt::format("{}{}", decoded.encoding->name, operands(decoded, pc));
}

}  // namespace mebots::soc
