// SPDX-License-Identifier: Apache-2.0
//
// Random Xpulp programs on the platform and on a second description of the instruction set (reference.hpp). The number
// of executed instructions comes from MEBOTS_LOCKSTEP_INSTRUCTIONS; scripts/lockstep.sh asks for many.
#include "reference.hpp"

#include "hart/hart.hpp"
#include "isa/encoding.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace mebots::soc {
namespace {

using test::XpulpReference;

constexpr std::uint32_t kRam = 0x80000000;
constexpr std::uint32_t kRamBytes = 4U << 20;            // further than post-increments get in one program
constexpr std::uint32_t kMiddle = kRam + kRamBytes / 2;  // where pointers start
constexpr std::uint32_t kLeave = 0xfe002e23;             // sw zero, -4(zero): to a device, which ends the run
constexpr unsigned kFirstPointer = 10;                   // x10 to x13
constexpr unsigned kLastPointer = 13;
constexpr unsigned kFirstOffset = 14;  // x14, x15: small numbers
constexpr unsigned kLastOffset = 15;
constexpr unsigned kTurns = 16;  // x16: small numbers above or equal 0

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint32_t word() { return static_cast<std::uint32_t>(engine_()); }
  std::uint32_t below(std::uint32_t count) { return word() % count; }
  /// Numbers as kernels and corners have them.
  std::uint32_t operand() {
    constexpr std::array<std::uint32_t, 12> kCorners{0,          1,          0xffffffff, 0x80000000, 0x7fffffff, 0x8000,
                                                     0x80007fff, 0x7fff8000, 0x80808080, 0x7f7f7f7f, 0x00ff00ff, 31};
    switch (below(8)) {
      case 0:
        return kCorners[below(kCorners.size())];
      case 1:
        return word() & 0x3ffU;
      case 2:
        return 0U - (word() & 0xffU);
      default:
        return word();
    }
  }

 private:
  std::mt19937_64 engine_;
};

/// Makes words of instructions out of the rows of the encoding table, with operands that keep accesses inside the RAM.
class Generator {
 public:
  explicit Generator(Random& random) : random_(random) {
    for (const auto& row : encodings()) {
      if (row.extension != Extension::xpulp || is_hardware_loop(row.op) || is_branch(row.op)) continue;
      (is_load(row.op) || is_store(row.op) ? accesses_ : computing_).push_back(&row);
    }
  }

  /// One instruction that goes straight on.
  std::uint32_t plain() {
    const bool access = random_.below(4) == 0;
    const auto& rows = access ? accesses_ : computing_;
    const auto& row = *rows[random_.below(static_cast<std::uint32_t>(rows.size()))];
    for (;;) {
      auto word = (random_.word() & ~row.mask) | row.match;
      if (access) {
        word = with(word, 15, kFirstPointer + random_.below(kLastPointer - kFirstPointer + 1));
        const auto offset = kFirstOffset + random_.below(kLastOffset - kFirstOffset + 1);
        const bool by_register = has_register_offset(row.format);
        if (is_store(row.op) && by_register) word = with(word, 7, offset);
        if (is_load(row.op) && by_register) word = with(word, 20, offset);
        if (is_load(row.op)) word = with(word, 7, free_register());
      } else {
        word = with(word, 7, free_register());
      }
      if (!is_reserved(row, word)) return word;
    }
  }

  std::vector<std::uint32_t> program(std::size_t length) {
    std::vector<std::uint32_t> words;
    while (words.size() < length) {
      switch (random_.below(16)) {
        case 0:
          branch(words);
          break;
        case 1:
          loop(words, random_.below(2), false);
          break;
        case 2:
          loop(words, 1, true);
          break;
        default:
          words.push_back(plain());
          break;
      }
    }
    words.push_back(plain());
    return words;
  }

 private:
  static std::uint32_t with(std::uint32_t word, unsigned low, std::uint32_t value) {
    return (word & ~(31U << low)) | value << low;
  }
  /// Not one of those that keep addresses and counts sensible.
  std::uint32_t free_register() {
    for (;;) {
      const auto index = random_.below(32);
      if (index < kFirstPointer || index > kTurns) return index;
    }
  }

  void branch(std::vector<std::uint32_t>& words) {
    const auto skipped = random_.below(3);
    const auto distance = 4 * (skipped + 1);
    words.push_back(0x63U | (2U + random_.below(2)) << 12 | random_.below(32) << 15 | random_.below(32) << 20 |
                    (distance >> 1 & 15U) << 8 | (distance >> 5) << 25);
    for (std::uint32_t i = 0; i < skipped; ++i) words.push_back(plain());
  }

  void loop(std::vector<std::uint32_t>& words, std::uint32_t number, bool nested) {
    std::vector<std::uint32_t> body;
    const auto before = random_.below(3);
    for (std::uint32_t i = 0; i < before; ++i) body.push_back(plain());
    if (nested) loop(body, 0, false);
    const auto after = 1 + random_.below(4);
    for (std::uint32_t i = 0; i < after; ++i) body.push_back(plain());

    const auto size = static_cast<std::uint32_t>(body.size());
    const auto lp = [&](std::uint32_t kind, std::uint32_t rs1, std::uint32_t immediate) {
      words.push_back(0x7bU | kind << 12 | number << 7 | rs1 << 15 | immediate << 20);
    };
    const auto turns = random_.below(5);
    switch (random_.below(3)) {
      case 0:
        lp(4, kTurns, 2 * size);
        break;
      case 1:
        if (2 * size < 32) {
          lp(5, 2 * size, turns);
          break;
        }
        [[fallthrough]];
      default:
        // Three instructions, the end last or first.
        if (random_.below(2) == 0) {
          lp(0, 0, 6);
          lp(3, 0, turns);
          lp(1, 0, 2 * size);
        } else {
          lp(1, 0, 4 + 2 * size);
          lp(0, 0, 4);
          lp(2, kTurns, 0);
        }
        break;
    }
    words.insert(words.end(), body.begin(), body.end());
  }

  Random& random_;
  std::vector<const Encoding*> computing_;
  std::vector<const Encoding*> accesses_;
};

/// A hart that leaves at a store into nothing.
class Platform : public Bus {
 public:
  Platform() : memory_(make_memory()), hart_(memory_, *this, Timing{CoreKind::ri5cy}, InstructionEnergy{}) {
    hart_.reset(kRam);
  }
  Hart& hart() { return hart_; }
  Memory& memory() { return memory_; }
  std::uint8_t* ram() { return memory_.regions()[0].data.get(); }

  BusReply load(std::uint32_t, std::uint64_t) override { return {}; }
  BusReply store(std::uint32_t, std::uint64_t, std::uint32_t) override { return BusReply::done(); }
  bool watched(std::uint32_t) override { return false; }

 private:
  static Memory make_memory() {
    Memory memory;
    memory.add("ram", kRam, kRamBytes);
    return memory;
  }
  Memory memory_;
  Hart hart_;
};

std::uint64_t wanted_instructions() {
  const auto* text = std::getenv("MEBOTS_LOCKSTEP_INSTRUCTIONS");
  return text == nullptr ? 300'000 : std::strtoull(text, nullptr, 10);
}

std::string listing(const std::vector<std::uint32_t>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto pc = kRam + 4 * static_cast<std::uint32_t>(i);
    text += fmt::format("  {:08x} {:08x} {}\n", pc, words[i], disassemble(words[i], pc));
  }
  return text;
}

TEST(Xpulp, RandomProgramsDoTheSameOnASecondDescription) {
  constexpr int kStarts = 8;  // of each program, with other registers
  Random random(20180223);
  Generator generator(random);
  Platform platform;
  XpulpReference reference;
  reference.ram_base = kRam;
  reference.ram.resize(kRamBytes);
  for (std::uint32_t i = 0; i < kRamBytes; ++i) platform.ram()[i] = static_cast<std::uint8_t>(random.word());
  std::memcpy(reference.ram.data(), platform.ram(), kRamBytes);
  reference.written_from = kRamBytes;
  std::map<const Encoding*, std::uint64_t> executed;
  std::uint64_t total = 0;
  std::uint64_t programs = 0;
  while (total < wanted_instructions()) {
    ++programs;
    auto words = generator.program(48);
    words.push_back(kLeave);
    words.push_back(0x0000006fU | (0U - 4U * static_cast<std::uint32_t>(words.size())) % 0x1000U << 20);
    const auto bytes = 4 * static_cast<std::uint32_t>(words.size());
    const auto leave_at = kRam + bytes - 8;
    platform.memory().write(kRam, {reinterpret_cast<const std::uint8_t*>(words.data()), bytes});
    platform.memory().changed(kRam, bytes);
    std::memcpy(reference.ram.data(), words.data(), bytes);
    for (int start = 0; start < kStarts; ++start) {
      for (unsigned i = 1; i < 32; ++i) {
        auto value = random.operand();
        if (i >= kFirstPointer && i <= kLastPointer) value = kMiddle + random.below(4096);
        if (i >= kFirstOffset && i <= kLastOffset) value = random.below(64) - 32U;
        if (i == kTurns) value = random.below(5);
        platform.hart().set_reg(i, value);
        reference.x[i] = value;
      }
      platform.hart().set_pc(kRam);
      reference.pc = kRam;
      const auto before = platform.hart().counters().instructions;
      ASSERT_EQ(platform.hart().run(platform.hart().counters().cycles + 1'000'000), Stop::device) << listing(words);
      std::uint64_t steps = 0;
      while (reference.pc != leave_at) {
        const auto index = (reference.pc - kRam) / 4;
        ASSERT_LT(index, words.size()) << listing(words);
        ASSERT_TRUE(reference.step(words[index])) << disassemble(words[index], reference.pc);
        ++executed[decode(words[index]).encoding];
        ++steps;
      }
      total += steps;
      ASSERT_EQ(platform.hart().counters().instructions - before, steps + 1) << listing(words);
      ASSERT_EQ(platform.hart().pc(), leave_at + 4);
      for (unsigned i = 0; i < 32; ++i) {
        ASSERT_EQ(platform.hart().reg(i), reference.x[i]) << register_name(i) << " after\n" << listing(words);
      }
    }
    const auto first = reference.written_from;
    const auto count = reference.written_to - std::min(first, reference.written_to);
    ASSERT_EQ(std::memcmp(platform.ram() + first, reference.ram.data() + first, count), 0) << listing(words);
    reference.written_from = kRamBytes;
    reference.written_to = 0;
  }
  EXPECT_EQ(std::memcmp(platform.ram(), reference.ram.data(), kRamBytes), 0);
  std::size_t rows = 0;
  for (const auto& row : encodings()) {
    if (row.extension != Extension::xpulp) continue;
    ++rows;
    EXPECT_GT(executed[&row], 0U) << row.name << row.suffix;
  }
  fmt::print("{} programs, {} instructions compared, {} kinds of Xpulp instructions\n", programs, total, rows);
}

TEST(Xpulp, EncodingsAreThoseOfASecondDescription) {
  Random random(4045);
  constexpr std::array<std::uint32_t, 9> kOpcodes{0x03, 0x0b, 0x23, 0x2b, 0x33, 0x57, 0x5b, 0x63, 0x7b};
  XpulpReference reference;
  reference.ram_base = kRam;
  reference.ram.resize(64);
  std::uint64_t legal = 0;
  const auto count = wanted_instructions();
  for (std::uint64_t i = 0; i < count; ++i) {
    auto word = (random.word() & ~0x7fU) | kOpcodes[random.below(kOpcodes.size())];
    if (random.below(2) == 0) word &= 0xc1ffffffU;  // more of those with few free bits
    if (random.below(2) == 0) word &= 0xfe0fffffU;
    if (random.below(2) == 0) word &= 0xfffff0ffU;
    // Every access reaches the RAM: all registers point there, or are 0 for what is added.
    reference.x.fill(kRam + 16);
    const auto decoded = decode(word);
    const bool xpulp = decoded.encoding != nullptr && decoded.encoding->extension == Extension::xpulp;
    if (is_load(decoded.op) || is_store(decoded.op)) {
      if (xpulp && has_register_offset(decoded.encoding->format)) {
        reference.x[word >> 20 & 31U] = 0;
        if (is_store(decoded.op)) reference.x[word >> 7 & 31U] = 0;
        reference.x[word >> 15 & 31U] = kRam + 16;
        if (((word >> 15 ^ word >> 20) & 31U) == 0 || ((word >> 15 ^ word >> 7) & 31U) == 0) continue;
      }
      if (decoded.op == Op::p_elw) word &= 0x000fffffU;
      if ((word >> 15 & 31U) == 0) continue;  // from address 0
    }
    reference.x[0] = 0;
    reference.pc = kRam;
    ASSERT_EQ(reference.step(word), xpulp) << fmt::format("0x{:08x} {}", word, disassemble(word, kRam));
    legal += xpulp ? 1 : 0;
  }
  EXPECT_GT(legal, count / 10);
  fmt::print("{} words decoded, {} of them Xpulp\n", count, legal);
}

}  // namespace
}  // namespace mebots::soc
