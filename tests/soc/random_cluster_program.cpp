// SPDX-License-Identifier: Apache-2.0
#include "random_cluster_program.hpp"

#include "random_text.hpp"

#include "isa/encoding.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <vector>

namespace mebots::soc::test {
namespace {

class ClusterAuthor : RandomText {
 public:
  explicit ClusterAuthor(std::uint32_t seed) : RandomText(seed) {
    for (const auto& row : encodings()) {
      if (row.extension != Extension::xpulp || is_hardware_loop(row.op) || is_branch(row.op)) continue;
      (is_load(row.op) || is_store(row.op) ? accesses_ : computing_).push_back(&row);
    }
    // Each program has its own size and frequencies of instructions.
    routines_ = 4U << below(3);
    length_ = 10U << below(3);
    patching_ = below(4);
    meeting_ = below(4);
    one_bank_ = below(2) == 0;
  }

  std::string write() {
    std::string body;
    for (unsigned i = 0; i < routines_; ++i) body += fmt::format("f{}:\n{}    ret\n", i, items(length_, 2));
    for (unsigned i = 0; i < kLeaves; ++i) body += fmt::format("g{}:\n{}    jr t5\n", i, items(5, 0));
    return fixed_part() + body + tables();
  }

 private:
  // t0, t1 and t2, and registers with a name below, have fixed purposes.
  static constexpr std::array<std::string_view, 15> kRegisters{"a0", "a1", "a2", "a3", "a4",  "a5",  "a6", "a7",
                                                               "t3", "t4", "s8", "s9", "s10", "s11", "t6"};
  static constexpr std::array<unsigned, 15> kNumbers{10, 11, 12, 13, 14, 15, 16, 17, 28, 29, 24, 25, 26, 27, 31};
  static constexpr std::array<std::string_view, 9> kCounters{"mcycle", "minstret", "0x780", "0x781",  "0x784",
                                                             "0x79e",  "cycle",    "mepc",  "mhartid"};
  static constexpr unsigned kLeaves = 4;

  std::string_view source() { return below(12) == 0 ? "zero" : any(kRegisters); }
  std::string_view target() { return any(kRegisters); }

  std::string items(unsigned count, int depth) {
    std::string text;
    while (count-- > 0) text += item(depth);
    return text;
  }

  std::string item(int depth) {
    switch (below(24)) {
      case 0:
      case 1:
      case 2:
        return fmt::format("    {} {}, {}, {}\n", any(kTwoSources), target(), source(), source());
      case 3:
      case 4:
        return fmt::format("    {} {}, {}, {}\n", any(kImmediates), target(), source(), immediate());
      case 5:
      case 6:
        return xpulp(computing_);
      case 7:
      case 8:
        return (below(2) == 0 ? fmt::format("    addi s6, s0, {}\n    andi s7, {}, 31\n", immediate(), source()) : "") +
               xpulp(accesses_);
      case 9:
      case 10:
      case 11:
      case 12:
        return access();
      case 13:
      case 14:
        return depth >= 0 ? forward(depth) : access();
      case 15:
        return depth > 0 ? loop(depth) : access();
      case 16:
        return depth > 0 ? hardware_loop(depth) : access();
      case 17:
        return depth == 2 ? straight() : access();
      case 18:
        return depth > 0 ? call() : access();
      case 19:
        return rare(depth);
      case 20:
        return patching_ != 0 && below(8) < patching_ ? sometimes(patch(), patching_ == 3 ? 3 : 63) : slot();
      case 21:
        return meeting_ != 0 && below(4) < meeting_ && depth == 2 ? sometimes(meet(), meeting_ == 3 ? 3 : 31)
                                                                  : access();
      case 22:
        return fmt::format(".Lmark{}:\n", marks_++);
      default:
        return fmt::format("    addi {}, {}, {}\n", any(kRegisters), any(kRegisters), static_cast<int>(below(64)) - 32);
    }
  }

  /// Returns a random instruction word of one of the rows. Its destination is one of kNumbers. Loads and stores use s6
  /// as pointer.
  std::string xpulp(const std::vector<const Encoding*>& rows) {
    for (;;) {
      const auto& row = *rows[below(static_cast<unsigned>(rows.size()))];
      auto word = (static_cast<std::uint32_t>(random_()) & ~row.mask) | row.match;
      const auto set = [&word](unsigned low, unsigned value) { word = (word & ~(31U << low)) | value << low; };
      const bool access = is_load(row.op) || is_store(row.op);
      if (access) set(15, 22);
      if (!is_store(row.op)) set(7, kNumbers[below(kNumbers.size())]);
      if (access && has_step_register(traits_of(row.op).mode)) set(is_store(row.op) ? 7 : 20, 23);
      if (access && row.op == Op::p_elw) continue;
      if (!is_reserved(row, word)) return fmt::format("    .4byte {:#010x}\n", word);
    }
  }

  std::string access() {
    const auto base = below(4) == 0 ? "s1" : "s0";
    const auto offset = (one_bank_ && below(3) != 0 ? below(4) * 64 : below(500) * 4) + (below(8) == 0 ? below(4) : 0);
    if (below(4) == 0) {
      return fmt::format("    andi t0, {}, {}\n    add t0, t0, {}\n    {} {}, {}(t0)\n", source(),
                         below(6) == 0 ? 0x7ff : 0x7fc, base, any(kLoads), any(kRegisters), below(64) * 4);
    }
    if (below(2) == 0) return fmt::format("    {} {}, {}({})\n", any(kLoads), target(), offset, base);
    return fmt::format("    {} {}, {}({})\n", any(kStores), source(), offset, base);
  }

  /// Returns a branch over some code. The branch is taken at random, never, rarely, or mostly.
  std::string forward(int depth) {
    const auto label = labels_++;
    const auto body = items(1 + (below(4) == 0 ? below(50) : below(6)), depth - 1);
    switch (below(5)) {
      case 0:
        return fmt::format("    bne zero, zero, .L{}\n{}.L{}:\n", label, body, label);
      case 1:
        return fmt::format("    andi t0, {}, 63\n    beqz t0, .L{}\n{}.L{}:\n", source(), label, body, label);
      case 2:
        return fmt::format("    andi t0, {}, 63\n    bnez t0, .L{}\n{}.L{}:\n", source(), label, body, label);
      default:
        return fmt::format("    {} {}, {}, .L{}\n{}.L{}:\n", any(kBranches), source(), source(), label, body, label);
    }
  }

  std::string loop(int depth) {
    const auto label = labels_++;
    const auto counter = depth == 2 ? "t1" : "t2";
    return fmt::format("    li {}, {}\n.L{}:\n{}    addi {}, {}, -1\n    bgtz {}, .L{}\n", counter,
                       below(8) == 0 ? 1 + below(200) : 1 + below(8), label, items(1 + below(8), depth - 1), counter,
                       counter, counter, label);
  }

  std::string hardware_loop(int depth) {
    const auto label = labels_++;
    if (marks_ > 1 && below(3) == 0) {
      // A hardware loop between any two marked addresses.
      return fmt::format(
          "    la t0, .Lmark{}\n    csrw 0x7B{}, t0\n    la t0, .Lmark{}\n    csrw 0x7B{}, t0\n    csrwi "
          "0x7B{}, {}\n",
          below(marks_), depth == 2 ? 4 : 0, below(marks_), depth == 2 ? 5 : 1, depth == 2 ? 6 : 2, below(4));
    }
    return fmt::format(
        "    andi t0, {}, 7\n.L{}:\n    .4byte 0x7b | 4 << 12 | {} << 7 | 5 << 15 | ((.Lend{} - .L{}) / 2) "
        "<< 20\n{}.Lend{}:\n{}",
        source(), label, depth - 1, label, label, items(1 + below(6), depth - 1), label, last());
  }

  std::string last() {
    return below(3) == 0 ? fmt::format("    lw {}, {}(s0)\n", target(), below(4) * 64)
                         : fmt::format("    addi {}, {}, 1\n", target(), source());
  }

  std::string straight() {
    std::string text;
    const auto kind = below(3);
    for (auto count = 20 + below(60); count-- > 0;) {
      if (kind == 0)
        text += fmt::format("    {} {}, {}, {}\n", kTwoSources[10 + below(8)], target(), source(), source());
      if (kind == 1) text += fmt::format("    lw {}, {}(s1)\n", target(), below(500) * 4 + below(4));
      if (kind == 2) text += fmt::format("    {} {}, {}(s0)\n", any(kStores), source(), below(4) * 64);
    }
    return text;
  }

  std::string call() {
    const auto leaf = below(kLeaves);
    if (below(2) == 0) return fmt::format("    jal t5, g{}\n", leaf);
    return fmt::format(
        "    la t0, leaves\n    andi t5, {}, {}\n    add t0, t0, t5\n    lw t0, 0(t0)\n    jalr t5, t0\n", source(),
        4 * (kLeaves - 1));
  }

  std::string rare(int depth) {
    switch (below(7)) {
      case 0:
      case 1:
        return fmt::format("    csrr {}, {}\n", any(kRegisters), any(kCounters));
      case 2:
        return sometimes("    ecall\n", 7);
      case 3:
        return sometimes("    fence.i\n", 31);
      case 4:
        return fmt::format("    csrw {}, {}\n", below(2) == 0 ? "0x7a0" : "0x7a1", source());
      case 5:
        return depth == 2 ? sometimes(fmt::format("    addi s0, s0, {}\n", below(2) == 0 ? 4 : -4), 15) : "    fence\n";
      default: {
        const auto label = labels_++;
        return fmt::format("    mulh {}, {}, {}\n    j .L{}\n.L{}:\n", target(), source(), source(), label, label);
      }
    }
  }

  /// Returns code that executes `body` rarely, in one of `mask` + 1 iterations.
  std::string sometimes(std::string_view body, unsigned mask) {
    const auto label = labels_++;
    return fmt::format("    srli t0, s4, {}\n    andi t0, t0, {}\n    bnez t0, .L{}\n{}.L{}:\n", below(12), mask, label,
                       body, label);
  }

  /// Returns code that other cores change: a 32-bit instruction, or two compressed instructions.
  std::string slot() {
    if (below(2) == 0)
      return fmt::format("    .option push\n    .option norvc\n.Lword{}: addi a0, a0, 1\n    .option pop\n", words_++);
    return fmt::format(".Lhalf{}: c.addi a1, 1\n    c.addi a2, 2\n", halves_++);
  }

  std::string patch() {
    const auto text = fmt::format("    la t0, pool\n    lw tp, {}(t0)\n", 4 * below(8));
    const auto end = below(2) == 0 ? "    fence.i\n" : "";
    if (words_ != 0 && below(2) == 0)
      return fmt::format("{}    la t0, .Lword{}\n    sw tp, 0(t0)\n{}", text, below(words_), end);
    if (halves_ == 0) return slot();
    return fmt::format("    la t0, pool_of_halves\n    lh tp, {}(t0)\n    la t0, .Lhalf{}\n    sh tp, {}(t0)\n{}",
                       2 * below(6), below(halves_), 2 * below(2), end);
  }

  std::string meet() {
    switch (below(5)) {
      case 0:
        return "    .insn i 0x03, 6, t0, EVENT_UNIT_BARRIER_WAIT_OFFSET(s2)\n";
      case 1:
        return "    .insn i 0x03, 6, t0, EVENT_UNIT_EVENT_WAIT_OFFSET(s2)\n";
      case 2:
        return fmt::format("    li t0, {}\n    sw t0, EVENT_UNIT_SOFTWARE_EVENT_OFFSET(s2)\n", below(512) | below(8)
                                                                                                                << 16);
      case 3:
        return fmt::format("    lw {}, EVENT_UNIT_EVENT_BUFFER_OFFSET(s2)\n    lw {}, CLUSTER_DMA_STATUS_OFFSET(s3)\n",
                           target(), target());
      default:
        return transfer();
    }
  }

  std::string transfer() {
    const auto row = below(2) == 0 ? 0U : 1 + below(below(2) == 0 ? 16 : 300);
    const auto size = row == 0 ? 1 + below(3000) : row * (1 + below(16));
    return fmt::format(R"(    li t0, {}
    sw t0, CLUSTER_DMA_L2_ADDRESS_OFFSET(s3)
    li t0, {}
    sw t0, CLUSTER_DMA_L1_ADDRESS_OFFSET(s3)
    li t0, {}
    sw t0, CLUSTER_DMA_SIZE_OFFSET(s3)
    li t0, {}
    sw t0, CLUSTER_DMA_ROW_OFFSET(s3)
    li t0, {}
    sw t0, CLUSTER_DMA_STRIDE_OFFSET(s3)
    li t0, {}
    sw t0, CLUSTER_DMA_START_OFFSET(s3)
)",
                       0x1C03F000 + below(4096), 0x10007000 + below(8192), size, row, below(600), 1 + below(2));
  }

  std::string fixed_part() {
    std::string fill;
    for (const auto reg : kRegisters) {
      fill += fmt::format("    mul s4, s4, t1\n    addi s4, s4, 1013\n    mv {}, s4\n", reg);
    }
    std::string fabric;
    for (unsigned i = 0; i < 6; ++i) fabric += chip_item();
    return fmt::format(R"(    .option norelax
_start: la t0, fabric_handler
    csrw mtvec, t0
    li t1, POWER_MANAGER_BASE
    la t0, core
    sw t0, POWER_MANAGER_CLUSTER_BOOT_OFFSET(t1)
    li t0, 1
    sw t0, POWER_MANAGER_CLUSTER_POWER_OFFSET(t1)
    li s2, EVENT_UNIT_BASE
    li s3, CLUSTER_DMA_BASE
    li s0, 0x1B001000
    li s1, 0x1C040000
    mv s6, s0
    li s4, {}
    li t1, 1664525
{}
    li t0, 1 << TIMER_INTERRUPT
    csrw mie, t0
    li t0, TIMER_BASE
    li t1, 20000
    sw t1, TIMER_COMPARE_LO_OFFSET(t0)
    sw zero, TIMER_COMPARE_HI_OFFSET(t0)
    csrsi mstatus, 8
fabric: li t1, 1664525
    mul s4, s4, t1
    addi s4, s4, 1013
    srli t0, s4, 20
    andi t0, t0, {}
    la t1, routines
    add t0, t0, t1
    lw t0, 0(t0)
    jalr t0
    li t1, POWER_MANAGER_BASE
{}
    j fabric
    # Each core that waits for an event gets one from time to time.
fabric_handler: csrr gp, mcause
    bltz gp, 1f
    csrr gp, mepc
    addi gp, gp, 4
    csrw mepc, gp
    mret
1:  csrw mscratch, t0
    li gp, TIMER_BASE
    lw t0, TIMER_TIME_LO_OFFSET(gp)
    li tp, {}
    add t0, t0, tp
    sw t0, TIMER_COMPARE_LO_OFFSET(gp)
    li gp, POWER_MANAGER_BASE
    lw gp, POWER_MANAGER_CLUSTER_POWER_OFFSET(gp)
    beqz gp, 1f
    li gp, EVENT_UNIT_BASE
    li t0, 0x101ff
    sw t0, EVENT_UNIT_SOFTWARE_EVENT_OFFSET(gp)
1:  csrr t0, mscratch
    mret
core: la t0, handler
    csrw mtvec, t0
    csrr t0, mhartid
    addi t1, t0, 77
    li s4, {}
    mul s4, s4, t1
    li t1, 1664525
{}
    li s0, L1_BASE + 0x8000
    slli t0, t0, {}
    add s0, s0, t0
    mv s6, s0
    li s1, 0x1C040000
    li s2, EVENT_UNIT_BASE
    li s3, CLUSTER_DMA_BASE
    li t0, 0x1ff
    sw t0, EVENT_UNIT_EVENT_MASK_OFFSET(s2)
turn: li t1, 1664525
    mul s4, s4, t1
    addi s4, s4, 1013
    srli t0, s4, 20
    andi t0, t0, {}
    la t1, routines
    add t0, t0, t1
    lw t0, 0(t0)
    jalr t0
    j turn
    .balign 4
handler: csrr gp, mepc
    addi gp, gp, 4
    csrw mepc, gp
    mret
)",
                       random_() | 1U, fill, 4 * (routines_ - 1), fabric, 5000 + below(30000), random_() | 1U, fill,
                       one_bank_ ? 0 : 2 + below(2) * 2, 4 * (routines_ - 1));
  }

  /// Returns an action that only the fabric controller executes.
  std::string chip_item() {
    switch (below(5)) {
      case 0:
        return sometimes(fmt::format("    li t0, {}\n    sw t0, POWER_MANAGER_CLUSTER_CLOCK_HZ_OFFSET(t1)\n",
                                     20'000'000 + below(150'000'000)),
                         7);
      case 1:
        return sometimes(fmt::format("    li t0, {}\n    sw t0, POWER_MANAGER_CLOCK_HZ_OFFSET(t1)\n",
                                     20'000'000 + below(200'000'000)),
                         7);
      case 2:
        return sometimes(
            fmt::format("    sw zero, POWER_MANAGER_CLUSTER_POWER_OFFSET(t1)\n    li t0, {}\n1: addi t0, t0, "
                        "-1\n    bnez t0, 1b\n    li t0, 1\n    sw t0, POWER_MANAGER_CLUSTER_POWER_OFFSET(t1)\n",
                        1 + below(300)),
            31);
      case 3:
        return "    wfi\n";
      default:
        return fmt::format("    li t0, {}\n    sw t0, EVENT_UNIT_SOFTWARE_EVENT_OFFSET(s2)\n", below(256) | below(8)
                                                                                                                << 16);
    }
  }

  std::string tables() {
    std::string text = "    .balign 4\nroutines:\n";
    for (unsigned i = 0; i < routines_; ++i) text += fmt::format("    .4byte f{}\n", i);
    text += "leaves:\n";
    for (unsigned i = 0; i < kLeaves; ++i) text += fmt::format("    .4byte g{}\n", i);
    return text + R"(    .option norvc
pool: addi a0, a0, 3
    xori a0, a1, 5
    lw a3, 64(s0)
    sw a3, 128(s0)
    div a2, a0, a3
    addi a0, a0, 1
    bne a0, a0, pool
    ecall
    .option rvc
pool_of_halves: c.addi a1, 3
    c.mv a1, a2
    c.nop
    c.lw a2, 0(s0)
    c.sw a2, 64(s0)
    c.add a2, a1
)";
  }

  std::vector<const Encoding*> computing_;
  std::vector<const Encoding*> accesses_;
  unsigned routines_ = 0;
  unsigned length_ = 0;
  unsigned patching_ = 0;
  unsigned meeting_ = 0;
  bool one_bank_ = false;
  unsigned labels_ = 0;
  unsigned marks_ = 0;
  unsigned words_ = 0;
  unsigned halves_ = 0;
};

}  // namespace

std::string random_cluster_program(std::uint32_t seed) {
  return ClusterAuthor(seed).write();
}

}  // namespace mebots::soc::test
