// SPDX-License-Identifier: Apache-2.0
// Compares Xpulp in translated code with the interpreter: both must have the same state at every limit.
#include "random_xpulp.hpp"

#include "hart/csr_numbers.hpp"
#include "support/same_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>

namespace mebots::soc::test {
namespace {

constexpr unsigned kOuterTurns = kFirstSpare;
constexpr unsigned kPointerStart = kLastSpare;

std::uint32_t addi(unsigned rd, unsigned rs1, std::uint32_t imm) {
  return 0x13U | rd << 7 | rs1 << 15 | imm << 20;
}

/// Returns a program: the iterations of random instructions, the end, and a trap handler that only returns.
std::vector<std::uint32_t> hot_program(Generator& generator) {
  std::vector<std::uint32_t> words;
  for (auto pointer = kFirstPointer; pointer <= kLastPointer; ++pointer) {
    words.push_back(addi(pointer, kPointerStart, 16 * pointer));
  }
  const auto body = generator.program(64);
  words.insert(words.end(), body.begin(), body.end());
  words.push_back(addi(kOuterTurns, kOuterTurns, 0xfff));
  words.push_back(0x00088463U);  // beqz x17: skips the next jump
  const auto back = 0U - 4U * static_cast<std::uint32_t>(words.size());
  words.push_back(0x6fU | (back & 0x7feU) << 20 | (back & 0x800U) << 9 | (back & 0xff000U) | (back & 0x100000U) << 11);
  words.push_back(kLeave);
  words.push_back(0x0000006fU);  // j .
  words.push_back(0x30200073U);  // mret
  return words;
}

void start(Platform& platform, const std::vector<std::uint32_t>& words, Random random, std::uint32_t pointers) {
  const auto bytes = 4 * static_cast<std::uint32_t>(words.size());
  platform.memory().write(kXpulpRam, {reinterpret_cast<const std::uint8_t*>(words.data()), bytes});
  platform.memory().changed(kXpulpRam, bytes);
  auto& hart = platform.hart();
  for (unsigned i = 1; i < 32; ++i) hart.set_reg(i, random.operand());
  for (auto i = kFirstOffset; i <= kLastOffset; ++i) hart.set_reg(i, random.below(64) - 32U);
  hart.set_reg(kTurns, random.below(5));
  hart.set_reg(kOuterTurns, 300);
  hart.set_reg(kPointerStart, pointers);
  hart.set_pc(kXpulpRam);
  hart.set_csr(csr::kMtvec, kXpulpRam + bytes - 4);
  hart.set_csr(csr::kMie, 1U << 11);
  hart.set_csr(csr::kMstatus, 8);
}

/// Runs each program with and without translation until long after it is hot, and compares the states. Each call of
/// run() has a random limit, and interrupts come at random times.
void compare(std::uint64_t seed, int programs, std::uint32_t pointers, std::set<const Encoding*>& seen,
             bool mostly_dots = false) {
  Random random(seed);
  Generator generator(random, mostly_dots);
  Platform translated;
  Platform interpreted(false);
  for (std::uint32_t i = 0; i < kXpulpRamBytes; ++i) translated.ram()[i] = static_cast<std::uint8_t>(random.word());
  std::memcpy(interpreted.ram(), translated.ram(), kXpulpRamBytes);
  for (int program = 0; program < programs; ++program) {
    const auto words = hot_program(generator);
    for (const auto word : words) seen.insert(decode(word).encoding);
    const Random registers(random.word());
    for (auto* platform : {&translated, &interpreted}) start(*platform, words, registers, pointers);
    auto stop = Stop::limit;
    while (stop == Stop::limit) {
      const auto longest = random.below(4) == 0 ? 20'000U : 90U;
      const auto limit = translated.hart().counters().cycles + 1 + random.below(longest);
      stop = translated.hart().run(limit);
      ASSERT_EQ(interpreted.hart().run(limit), stop);
      ASSERT_TRUE(mebots::test::same_state(translated.hart(), interpreted.hart()))
          << "at cycle " << limit << ", pc "
          << fmt::format("{:x} and {:x}", translated.hart().pc(), interpreted.hart().pc()) << " of\n"
          << listing(words);
      const bool interrupt = random.below(16) == 0;
      for (auto* platform : {&translated, &interpreted}) platform->hart().set_interrupt(11, interrupt);
    }
    ASSERT_EQ(stop, Stop::device) << listing(words);
    ASSERT_EQ(std::memcmp(translated.ram(), interpreted.ram(), kXpulpRamBytes), 0) << listing(words);
    for (auto* platform : {&translated, &interpreted}) platform->hart().set_interrupt(11, false);
  }
}

TEST(XpulpTranslation, RunsAsInterpreted) {
  std::set<const Encoding*> seen;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    compare(seed, 4, kMiddle, seen);
    if (HasFatalFailure()) return;
  }
  for (const auto& row : encodings()) {
    if (row.extension != Extension::xpulp) continue;
    EXPECT_TRUE(seen.contains(&row)) << row.name;
  }
}

/// The translator keeps registers that are mostly used by dot products in vector registers, even if other instructions
/// use them, too.
TEST(XpulpTranslation, RunsDotProductsAsInterpreted) {
  std::set<const Encoding*> seen;
  for (std::uint64_t seed = 101; seed <= 180; ++seed) {
    compare(seed, 4, kMiddle, seen, true);
    if (HasFatalFailure()) return;
  }
  for (const auto& row : encodings()) {
    if (!is_dot_product(row.op) && !Generator::computes_in_32_bits(row)) continue;
    EXPECT_TRUE(seen.contains(&row)) << row.name;
  }
}

/// A call writes its return address into x1. Translated code may keep x1 in a vector register, because x1 is an
/// operand of dot products.
TEST(XpulpTranslation, RunsCallsThatWriteAnOperandOfDotProducts) {
  constexpr std::array<std::uint32_t, 10> kWords{0xa83110d7U,  // pv.sdotusp.b x1, x2, x3, and three times more
                                                 0xa83110d7U, 0xa83110d7U, 0xa83110d7U,
                                                 0x00160613U,   // addi x12, x12, 1
                                                 0x000280e7U,   // jalr x1, 0(x5), past the next two
                                                 0x00168693U,   // addi x13, x13, 1
                                                 0xfe5ff06fU,   // j to the start
                                                 0x00170713U,   // addi x14, x14, 1
                                                 0xfddff06fU};  // j to the start
  std::array<std::vector<std::byte>, 2> states;
  for (const bool translate : {false, true}) {
    Platform platform(translate);
    platform.memory().write(kXpulpRam, {reinterpret_cast<const std::uint8_t*>(kWords.data()), sizeof kWords});
    auto& hart = platform.hart();
    hart.set_reg(2, 0x01020304);
    hart.set_reg(3, 0x7f80ff01);
    hart.set_reg(5, kXpulpRam + 0x20);
    EXPECT_EQ(hart.run(20'000), Stop::limit);
    EXPECT_EQ(hart.reg(13), 0U);
    EXPECT_EQ(hart.code().is_translated(), translate && translate::can_translate());
    states[translate ? 1 : 0] = state::save(hart);
  }
  EXPECT_EQ(states[0], states[1]);
}

/// Loads operands of dot products from both memories. One load overwrites the register that contains its step.
TEST(XpulpTranslation, LoadsOperandsOfDotProductsAsInterpreted) {
  constexpr std::array<std::uint32_t, 10> kWords{0x20e5770bU,  // p.lw x14, x14(x10!): the next step, 4 or 8
                                                 0x20e5f783U,  // p.lw x15, x14(x11), in the small memory
                                                 0x00460613U,  // addi x12, x12, 4
                                                 0xa8f71857U,  // pv.sdotusp.b x16, x14, x15
                                                 0xa8f71857U,  // the same instruction three more times
                                                 0xa8f71857U, 0xa8f71857U,
                                                 0x0f087813U,   // andi x16, x16, 240
                                                 0x010685b3U,   // add x11, x13, x16
                                                 0xfddff06fU};  // j back
  std::array<std::vector<std::byte>, 2> states;
  for (const bool translate : {false, true}) {
    Platform platform(translate);
    platform.memory().write(kXpulpRam, {reinterpret_cast<const std::uint8_t*>(kWords.data()), sizeof kWords});
    Random random(1);
    for (std::uint32_t at = 4096; at < kXpulpRamBytes; at += 4) {
      const std::uint32_t step = 4U << random.below(2);
      std::memcpy(platform.ram() + at, &step, 4);
    }
    for (std::uint32_t at = 0; at < kXpulpSmallBytes; ++at) {
      platform.small()[at] = static_cast<std::uint8_t>(random.word());
    }
    auto& hart = platform.hart();
    hart.set_reg(10, kXpulpRam + 4096);
    hart.set_reg(11, kXpulpSmall);
    hart.set_reg(13, kXpulpSmall);
    hart.set_reg(14, 4);
    EXPECT_EQ(hart.run(200'000), Stop::limit);
    EXPECT_GT(hart.reg(10), kXpulpRam + 50'000);
    EXPECT_EQ(hart.code().is_translated(), translate && translate::can_translate());
    states[translate ? 1 : 0] = state::save(hart);
  }
  EXPECT_EQ(states[0], states[1]);
}

/// If the access of a post-increment load or store fails, the pointer stays unchanged.
TEST(XpulpTranslation, FaultsInAPostIncrementAsInterpreted) {
  constexpr std::uint32_t kEnd = kXpulpRam + kXpulpRamBytes;
  for (const std::uint32_t access : {
           0x0045250bU,  // p.lw x10, 4(x10!): the loaded value wins
           0x0045258bU,  // p.lw x11, 4(x10!)
           0x00b5222bU,  // p.sw x11, 4(x10!)
           0x00b5162bU,  // p.sh x11, 12(x10!)
       }) {
    std::array<std::vector<std::byte>, 2> states;
    for (const bool translate : {false, true}) {
      Platform platform(translate);
      auto& hart = platform.hart();
      const std::array<std::uint32_t, 3> words{access, 0x00160613U, 0xff9ff06fU};  // addi x12, x12, 1; j back
      platform.memory().write(kXpulpRam, {reinterpret_cast<const std::uint8_t*>(words.data()), sizeof words});
      // Each word contains the address of the next word, because a load may overwrite its own pointer.
      for (auto at = kEnd - 4000; at < kEnd; at += 4) {
        const auto next = at + 4;
        std::memcpy(platform.ram() + (at - kXpulpRam), &next, 4);
      }
      hart.set_reg(10, kEnd - 4000);
      const auto stop = hart.run(1'000'000);
      if (stop == Stop::fault) {
        EXPECT_EQ(hart.fault().last.value, hart.reg(10));
      } else {
        EXPECT_EQ(stop, Stop::device) << "a word is stored there";
      }
      EXPECT_GE(hart.reg(10), kEnd);
      states[translate ? 1 : 0] = state::save(hart);
    }
    EXPECT_EQ(states[0], states[1]) << disassemble(access, 0);
  }
}

}  // namespace
}  // namespace mebots::soc::test
