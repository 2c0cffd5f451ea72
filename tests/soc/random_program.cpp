// SPDX-License-Identifier: Apache-2.0
#include "random_program.hpp"

#include "machine.hpp"
#include "random_text.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace mebots::soc::test {
namespace {

constexpr int kFunctions = 4;

class Author : RandomText {
 public:
  explicit Author(std::uint32_t seed) : RandomText(seed) {}

  std::string write() {
    std::string text = R"(
_start: la sp, stack_top
    la s0, data
    la s1, 0x70000000
    csrwi mcountinhibit, 0
    la t0, handler
    csrw mtvec, t0
    li t0, 0x880
    csrw mie, t0
    csrsi mstatus, 8
    li s2, 260
)";
    for (const auto reg : kRegisters) text += fmt::format("    li {}, {}\n", reg, random_() & 0xffffffffU);
    text += "outer:\n" + items(30, 2);
    text += "    addi s2, s2, -1\n    beqz s2, done\n    j outer\ndone:\n";
    text += kEnd;
    for (int i = 0; i < kFunctions; ++i) text += fmt::format("f{}:\n{}    ret\n", i, items(8, 0));
    text += R"(
    .balign 256
handler: csrw mscratch, t0
    csrr t0, mcause
    bltz t0, 1f
    csrr t0, mepc
    addi t0, t0, 4
    csrw mepc, t0
1:  lw t0, interrupts
    addi t0, t0, 1
    sw t0, interrupts, gp
    csrr t0, mscratch
    mret
    .data
    .balign 64
data: .space 4096
interrupts: .word 0
table: .word f0, f1, f2, f3
    .space 1024
stack_top:
    .text
)";
    return text;
  }

 private:
  // The program uses more registers than the host has. t0, t1, t2, gp and s0 to s2 have fixed purposes.
  static constexpr std::array<std::string_view, 18> kRegisters{"a0", "a1", "a2", "a3", "a4", "a5", "a6",  "a7",  "s3",
                                                               "s4", "s5", "s6", "s7", "s8", "s9", "s10", "s11", "tp"};
  static constexpr std::array<std::string_view, 3> kShifts{"slli", "srli", "srai"};

  /// Returns a source register, which is sometimes x0.
  std::string_view source() { return below(12) == 0 ? "zero" : any(kRegisters); }
  std::string_view target() { return below(25) == 0 ? "zero" : any(kRegisters); }

  std::string items(unsigned count, int depth) {
    std::string text;
    while (count-- > 0) text += item(depth);
    return text;
  }

  std::string item(int depth) {
    switch (below(20)) {
      case 0:
      case 1:
      case 2:
      case 3:
      case 4:
        return fmt::format("    {} {}, {}, {}\n", any(kTwoSources), target(), source(), source());
      case 5:
      case 6:
        return fmt::format("    {} {}, {}, {}\n", any(kImmediates), target(), source(), immediate());
      case 7:
        return fmt::format("    {} {}, {}, {}\n", any(kShifts), target(), source(), below(32));
      case 8:
        return fmt::format("    lui {}, {}\n    auipc {}, 1\n", target(), below(1 << 20), target());
      case 9:
      case 10:
      case 11:
      case 12:
        return access();
      case 13:
      case 14: {
        const auto label = labels_++;
        return fmt::format("    {} {}, {}, .L{}\n{}.L{}:\n", any(kBranches), source(), source(), label,
                           items(1 + below(5), 0), label);
      }
      case 15:
        return depth > 0 ? loop(depth) : access();
      case 16:
        return depth > 0 ? call() : fmt::format("    mv {}, {}\n", target(), any(kRegisters));
      case 17:
        return rare();
      default:
        return fmt::format("    addi {}, {}, {}\n", any(kRegisters), any(kRegisters), static_cast<int>(below(64)) - 32);
    }
  }

  std::string access() {
    const auto base = below(4) == 0 ? "s1" : "s0";
    const auto offset = below(500) * 4 + (below(8) == 0 ? below(4) : 0);
    if (below(3) == 0) {
      // An address from data, sometimes misaligned; the loaded value is used at once.
      return fmt::format("    andi t0, {}, {}\n    add t0, t0, {}\n    {} {}, {}(t0)\n", source(),
                         below(6) == 0 ? 0x7ff : 0x7fc, base, any(kLoads), any(kRegisters), below(64) * 4);
    }
    if (below(2) == 0) return fmt::format("    {} {}, {}({})\n", any(kLoads), target(), offset, base);
    return fmt::format("    {} {}, {}({})\n", any(kStores), source(), offset, base);
  }

  std::string loop(int depth) {
    const auto label = labels_++;
    const auto counter = depth == 2 ? "t1" : "t2";
    return fmt::format("    li {}, {}\n.L{}:\n{}    addi {}, {}, -1\n    bnez {}, .L{}\n", counter, 1 + below(6), label,
                       items(1 + below(6), depth - 1), counter, counter, counter, label);
  }

  std::string call() {
    const auto function = below(kFunctions);
    switch (below(3)) {
      case 0:
        return fmt::format("    la t0, f{}\n    jalr t0\n", function);
      case 1:
        return fmt::format("    lw t0, table + {}\n    jalr t0\n", 4 * function);
      default:
        return fmt::format("    jal f{}\n", function);
    }
  }

  static constexpr std::array<std::string_view, 3> kCsrChanges{"w", "s", "c"};
  static constexpr std::array<std::string_view, 5> kCsrs{"mstatus", "mepc", "mtvec", "mie", "misa"};

  std::string rare() {
    switch (below(10)) {
      case 0:
        return fmt::format("    csrr {}, {}\n", any(kRegisters), below(4) == 0 ? "mcycleh" : "mcycle");
      case 1:
        return fmt::format("    csrr {}, {}\n", any(kRegisters), below(4) == 0 ? "minstreth" : "minstret");
      case 6:
        return fmt::format("    csrr{} {}, mscratch, {}\n", any(kCsrChanges), target(), source());
      case 7:
        return fmt::format("    csrr{}i {}, mscratch, {}\n", any(kCsrChanges), target(), below(32));
      case 8:
        return fmt::format("    csrr {}, {}\n", any(kRegisters), any(kCsrs));
      case 9:
        return fmt::format("    csrrw {0}, mcause, {0}\n", any(kRegisters));
      case 2:
        return "    .option push\n    .option norvc\n    ecall\n    .option pop\n";
      case 3:
        return "    fence\n";
      case 4:
        return "    fence.i\n";
      default: {
        const auto label = labels_++;
        return fmt::format("    mulh {}, {}, {}\n    j .L{}\n.L{}:\n", any(kRegisters), source(), source(), label,
                           label);
      }
    }
  }

  int labels_ = 0;
};

}  // namespace

std::string random_program(std::uint32_t seed) {
  return Author(seed).write();
}

}  // namespace mebots::soc::test
