// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include "isa/encoding.hpp"

#include <algorithm>
#include <array>
#include <random>

namespace mebots::soc::test {
namespace {

// Registers with a fixed purpose: random instructions only read them.
constexpr std::uint32_t kSp = 2;       // address in the data, with any alignment
constexpr std::uint32_t kCounter = 5;  // counter of a loop
constexpr std::uint32_t kNowhere = 7;  // contains an address without memory
constexpr std::uint32_t kPointer = 8;  // x8, x9: addresses in the data
constexpr std::uint32_t kOtherPointer = 9;
constexpr std::uint32_t kCheckpointEvery = 8;

constexpr std::uint32_t kMstatus = 0x300;
constexpr std::uint32_t kMisa = 0x301;
constexpr std::uint32_t kMtvec = 0x305;
constexpr std::uint32_t kMscratch = 0x340;
constexpr std::uint32_t kMepc = 0x341;
constexpr std::uint32_t kMcause = 0x342;
constexpr std::uint32_t kMtval = 0x343;
constexpr std::uint32_t kMhartid = 0xf14;

std::uint32_t i_type(std::uint32_t opcode, std::uint32_t funct3, std::uint32_t rd, std::uint32_t rs1,
                     std::uint32_t imm) {
  return opcode | rd << 7 | funct3 << 12 | rs1 << 15 | imm << 20;
}
std::uint32_t addi(std::uint32_t rd, std::uint32_t rs1, std::uint32_t imm) {
  return i_type(0x13, 0, rd, rs1, imm & 0xfffU);
}
std::uint32_t lw(std::uint32_t rd, std::uint32_t offset, std::uint32_t rs1) {
  return i_type(0x03, 2, rd, rs1, offset);
}
std::uint32_t sw(std::uint32_t rs2, std::uint32_t offset, std::uint32_t rs1) {
  return 0x2023U | (offset & 31U) << 7 | rs1 << 15 | rs2 << 20 | (offset >> 5) << 25;
}
std::uint32_t csr(std::uint32_t funct3, std::uint32_t rd, std::uint32_t number, std::uint32_t rs1) {
  return i_type(0x73, funct3, rd, rs1, number);
}
std::uint32_t branch(std::uint32_t funct3, std::uint32_t rs1, std::uint32_t rs2, std::uint32_t distance) {
  return 0x63U | funct3 << 12 | rs1 << 15 | rs2 << 20 | (distance >> 11 & 1U) << 7 | (distance >> 1 & 15U) << 8 |
         (distance >> 5 & 63U) << 25 | (distance >> 12 & 1U) << 31;
}
std::uint32_t jal(std::uint32_t rd, std::uint32_t distance) {
  return 0x6fU | rd << 7 | (distance & 0xff000U) | (distance >> 11 & 1U) << 20 | (distance >> 1 & 0x3ffU) << 21 |
         (distance >> 20 & 1U) << 31;
}
std::uint32_t compressed_jump(bool links, std::uint32_t d) {
  return (links ? 0x2001U : 0xa001U) | (d >> 11 & 1U) << 12 | (d >> 4 & 1U) << 11 | (d >> 8 & 3U) << 9 |
         (d >> 10 & 1U) << 8 | (d >> 6 & 1U) << 7 | (d >> 7 & 1U) << 6 | (d >> 1 & 7U) << 3 | (d >> 5 & 1U) << 2;
}
std::uint32_t compressed_branch(bool not_zero, std::uint32_t rs1, std::uint32_t d) {
  return (not_zero ? 0xe001U : 0xc001U) | (rs1 - 8) << 7 | (d >> 8 & 1U) << 12 | (d >> 3 & 3U) << 10 |
         (d >> 6 & 3U) << 5 | (d >> 1 & 3U) << 3 | (d >> 5 & 1U) << 2;
}

class Maker {
 public:
  Maker(std::uint64_t seed) : engine_(seed) {
    for (const auto& row : encodings()) {
      if (row.extension != Extension::standard || is_branch(row.op) || is_jump(row.op) || is_csr(row.op)) continue;
      if (row.op == Op::ecall || row.op == Op::ebreak || row.op == Op::mret || row.op == Op::wfi) continue;
      if (row.format == Format::fence) continue;
      rows_.push_back(&row);
    }
  }

  LockstepProgram make(std::size_t length, std::uint32_t turns) {
    start(turns);
    while (random_count_ < length) piece();
    checkpoint();
    finish();
    functions();
    LockstepProgram program;
    program.code = std::move(code_);
    for (std::uint32_t i = 0; i < Layout::kDataBytes; ++i) program.data.push_back(static_cast<std::uint8_t>(word()));
    for (std::uint32_t i = 0; i < turns * 32; ++i) {
      const auto value = start_value(i % 32);
      for (unsigned byte = 0; byte < 4; ++byte)
        program.starts.push_back(static_cast<std::uint8_t>(value >> (8 * byte)));
    }
    return program;
  }

 private:
  std::uint32_t word() { return static_cast<std::uint32_t>(engine_()); }
  std::uint32_t below(std::uint32_t count) { return word() % count; }

  void emit(std::uint32_t value) {
    code_.push_back(static_cast<std::uint8_t>(value));
    code_.push_back(static_cast<std::uint8_t>(value >> 8));
    if (is_compressed(value)) return;
    code_.push_back(static_cast<std::uint8_t>(value >> 16));
    code_.push_back(static_cast<std::uint8_t>(value >> 24));
  }
  std::uint32_t here() const { return static_cast<std::uint32_t>(code_.size()); }
  void overwrite(std::uint32_t at, std::uint32_t value) {
    const auto count = is_compressed(value) ? 2U : 4U;
    for (std::uint32_t i = 0; i < count; ++i) code_[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  void load_address(std::uint32_t rd, std::uint32_t address) {
    emit(0x37U | rd << 7 | ((address + 0x800U) & 0xfffff000U));
    emit(addi(rd, rd, address));
  }

  std::uint32_t start_value(unsigned index) {
    constexpr std::array<std::uint32_t, 8> kCorners{0, 1, 0xffffffff, 0x80000000, 0x7fffffff, 31, 32, 0x8000};
    if (index == kSp || index == kPointer || index == kOtherPointer) {
      return Layout::kData + Layout::kDataBytes / 4 + below(Layout::kDataBytes / 2);
    }
    if (index == kNowhere) return 0x90000000U + (word() & 0x5ffffff0U);
    const auto kind = below(6);
    return kind == 0 ? kCorners[below(kCorners.size())] : kind == 1 ? below(64) : word();
  }
  static bool has_task(std::uint32_t index) {
    return index == kSp || index == kCounter || index == kNowhere || index == kPointer || index == kOtherPointer;
  }

  /// Writes one iteration: it loads all registers from the table, executes the random code, and jumps to the next
  /// iteration.
  void start(std::uint32_t turns) {
    emit(0);  // later replaced by a jump over the handler
    emit(0);
    while (here() % 4 != 0) emit(1);
    const auto handler_at = here();
    handler();
    const auto main_at = here();
    overwrite(0, jal(0, main_at));
    load_address(5, Layout::kCode + handler_at);
    emit(csr(1, 0, kMtvec, 5));
    load_address(5, Layout::kLog);
    emit(csr(1, 0, kMscratch, 5));
    turn_at_ = here();
    // Increments the counter of iterations. x31 becomes the address of the register values with which this iteration
    // starts.
    load_address(30, Layout::kControl);
    emit(lw(31, 0, 30));
    emit(addi(29, 31, 1));
    emit(sw(29, 0, 30));
    emit(addi(28, 0, turns));
    const auto leave_at = here();
    emit(0x63);  // later replaced by the branch out of the loop
    emit(0x00000013);
    leave_at_ = leave_at;
    emit(i_type(0x13, 1, 31, 31, 7));  // x31 times 128
    load_address(30, Layout::kStarts);
    emit(0x33U | 31U << 7 | 31U << 15 | 30U << 20);
    for (std::uint32_t i = 1; i < 32; ++i) emit(lw(i, 4 * i, 31));
  }

  void handler() {
    emit(csr(1, kSp, kMscratch, kSp));
    emit(sw(5, 0, kSp));
    emit(sw(6, 4, kSp));
    emit(csr(2, 5, kMcause, 0));
    emit(sw(5, 8, kSp));
    emit(csr(2, 5, kMtval, 0));
    emit(sw(5, 12, kSp));
    emit(csr(2, 5, kMstatus, 0));
    emit(sw(5, 16, kSp));
    emit(csr(2, 5, kMepc, 0));
    emit(sw(5, 20, kSp));
    // The handler skips the instruction, of 2 or 4 bytes.
    emit(i_type(0x03, 5, 6, 5, 0));
    emit(i_type(0x13, 7, 6, 6, 3));
    emit(addi(6, 6, static_cast<std::uint32_t>(-3)));
    emit(i_type(0x13, 3, 6, 6, 1));
    emit(i_type(0x13, 1, 6, 6, 1));
    emit(addi(6, 6, 2));
    emit(0x33U | 5U << 7 | 5U << 15 | 6U << 20);
    emit(csr(1, 0, kMepc, 5));
    emit(lw(5, 0, kSp));
    emit(lw(6, 4, kSp));
    emit(addi(kSp, kSp, Layout::kRecordBytes));
    emit(csr(1, kSp, kMscratch, kSp));
    emit(0x30200073);
  }

  void checkpoint() {
    emit(csr(1, kSp, kMscratch, kSp));
    for (std::uint32_t i = 1; i < 32; ++i) {
      if (i != kSp) emit(sw(i, 4 * i, kSp));
    }
    emit(csr(2, 1, kMscratch, 0));
    emit(sw(1, 4 * kSp, kSp));
    emit(lw(1, 4, kSp));
    emit(addi(kSp, kSp, Layout::kRecordBytes));
    emit(csr(1, kSp, kMscratch, kSp));
  }

  void count(std::uint32_t instructions = 1) {
    random_count_ += instructions;
    since_checkpoint_ += instructions;
    if (since_checkpoint_ < kCheckpointEvery) return;
    since_checkpoint_ = 0;
    checkpoint();
  }

  void finish() {
    // The way back to the next iteration is a jump, because a branch does not reach as far.
    emit(jal(0, turn_at_ - here()));
    overwrite(leave_at_, branch(4, 31, 28, 8));                // blt turn, turns: skips the next instruction
    overwrite(leave_at_ + 4, jal(0, here() - leave_at_ - 4));  // end of the program
    load_address(5, Layout::kTohost);
    emit(addi(6, 0, 1));
    emit(sw(6, 0, 5));
    load_address(5, 0x00100000);  // powers off by the test device of QEMU's virt machine
    load_address(6, 0x5555);
    emit(sw(6, 0, 5));
    emit(jal(0, 0));
  }

  void functions() {
    for (const auto at : calls_) {
      while (here() % 2 != 0) code_.push_back(0);
      const auto target = here();
      const auto size = 1 + below(4);
      in_function_ = true;
      for (std::uint32_t i = 0; i < size; ++i) straight();
      in_function_ = false;
      emit(below(2) == 0 ? 0x8082U : 0x00008067U);
      if (at.by_register) {
        const auto distance = target - at.offset;
        overwrite(at.offset, 0x97U | 1U << 7 | ((distance + 0x800U) & 0xfffff000U));
        overwrite(at.offset + 4, i_type(0x67, 0, 1, 1, distance & 0xfffU));
      } else {
        overwrite(at.offset, jal(1, target - at.offset));
      }
    }
  }

  std::uint32_t straight_word() {
    for (;;) {
      const auto& row = *rows_[below(static_cast<std::uint32_t>(rows_.size()))];
      auto value = (word() & ~row.mask) | row.match;
      if (is_compressed(row.format)) value &= 0xffffU;
      auto decoded = decode(value, Extension::standard);
      if (decoded.encoding != &row) continue;
      const bool access = is_load(row.op) || is_store(row.op);
      if (access && decoded.rs1 != kSp && decoded.rs1 != kPointer && decoded.rs1 != kOtherPointer) {
        if (is_compressed(row.format)) continue;
        // Sometimes causes an access fault, but never of a misaligned access, whose fault address may differ in QEMU.
        const bool faults = below(16) == 0;
        value = (value & ~(31U << 15)) | (faults ? kNowhere : kPointer + below(2)) << 15;
        if (faults) value &= is_store(row.op) ? 0xfffff07fU : 0xff0fffffU;
        decoded = decode(value, Extension::standard);
      }
      const bool writes = !is_store(row.op);
      // c.addi16sp may move the stack pointer slightly.
      const bool moves_sp = row.format == Format::c_addi16sp && below(8) == 0;
      if (writes && has_task(decoded.rd) && !moves_sp) continue;
      if (in_function_ && writes && decoded.rd == 1) continue;
      return value;
    }
  }
  void straight() {
    emit(straight_word());
    ++random_count_;
  }

  void piece() {
    switch (below(24)) {
      case 0:
      case 1:
        skip();
        break;
      case 2:
        loop();
        break;
      case 3:
        call();
        break;
      case 4:
        csr_access();
        break;
      case 5:
        trap();
        break;
      case 6:
        emit(below(2) == 0 ? 0x0ff0000fU : 0x0000100fU);  // fence or fence.i
        count();
        break;
      default:
        straight();
        --random_count_;
        count();
        break;
    }
  }

  /// Writes a branch or jump over some instructions.
  void skip() {
    const auto at = here();
    const auto kind = below(6);
    const bool is_short = kind == 1 || kind == 2 || kind == 4;
    emit(is_short ? 1U : 0x13U);
    const auto skipped = below(5);
    for (std::uint32_t i = 0; i < skipped; ++i) straight();
    const auto distance = here() - at;
    constexpr std::array<std::uint32_t, 6> kRelations{0, 1, 4, 5, 6, 7};
    switch (kind) {
      case 0:
        overwrite(at, jal(below(2) == 0 ? 0 : 1, distance));
        break;
      case 1:
        overwrite(at, compressed_jump(false, distance));
        break;
      case 2:
        overwrite(at, compressed_jump(true, distance));
        break;
      case 4:
        overwrite(at, compressed_branch(below(2) == 0, 8 + below(8), distance));
        break;
      default:
        overwrite(at, branch(kRelations[below(6)], below(32), below(32), distance));
        break;
    }
    count(1);
  }

  /// Writes a loop: a backward branch that is taken a few times.
  void loop() {
    emit(addi(kCounter, 0, 1 + below(4)));
    const auto body = here();
    const auto size = 1 + below(5);
    for (std::uint32_t i = 0; i < size; ++i) straight();
    emit(addi(kCounter, kCounter, static_cast<std::uint32_t>(-1)));
    emit(branch(1, kCounter, 0, body - here()));
    count(3);
  }

  void call() {
    const bool by_register = below(2) == 0;
    calls_.push_back({here(), by_register});
    emit(0x13);
    if (by_register) emit(0x13);
    count(by_register ? 2 : 1);
  }

  void csr_access() {
    // Does not read mstatus: after an mret, QEMU's value names user mode as the previous mode, although neither machine
    // has user mode. The handler stores mstatus instead.
    constexpr std::array<std::uint32_t, 3> kReadOnly{kMtvec, kMisa, kMhartid};
    constexpr std::array<std::uint32_t, 3> kMissing{0x5c0, 0x180, 0x7c5};
    auto rd = below(32);
    while (has_task(rd)) rd = below(32);
    switch (below(4)) {
      case 0:
        emit(csr(2, rd, kReadOnly[below(3)], 0));
        break;
      case 1:
        emit(csr(1 + below(3), rd, kMissing[below(3)], below(32)));
        break;
      default: {
        constexpr std::array<std::uint32_t, 6> kOperations{1, 2, 3, 5, 6, 7};
        emit(csr(kOperations[below(6)], rd, below(2) == 0 ? kMtval : kMcause, below(32)));
        break;
      }
    }
    count();
  }

  void trap() {
    constexpr std::array<std::uint32_t, 6> kIllegal{0x0000, 0xffffffff, 0x0000705b, 0x02a5d033 | 0x04000000,
                                                    0x8002, 0x00003023};
    if (below(2) == 0) {
      emit(0x00000073);
    } else {
      emit(kIllegal[below(kIllegal.size())]);
    }
    count();
  }

  struct Call {
    std::uint32_t offset;
    bool by_register;
  };

  std::mt19937_64 engine_;
  std::vector<const Encoding*> rows_;
  std::vector<std::uint8_t> code_;
  std::vector<Call> calls_;
  std::uint64_t random_count_ = 0;
  std::uint32_t since_checkpoint_ = 0;
  std::uint32_t turn_at_ = 0;
  std::uint32_t leave_at_ = 0;
  bool in_function_ = false;
};

}  // namespace

LockstepProgram make_lockstep_program(std::uint64_t seed, std::size_t length, std::uint32_t turns) {
  return Maker(seed).make(length, turns);
}

}  // namespace mebots::soc::test
