// SPDX-License-Identifier: Apache-2.0
// Runs random Xpulp programs on a hart and on a second implementation of the instruction set (reference.hpp).
// MEBOTS_LOCKSTEP_INSTRUCTIONS is the number of executed instructions (scripts/lockstep.sh).
#include "random_xpulp.hpp"
#include "reference.hpp"

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

using test::Generator;
using test::kFirstOffset;
using test::kFirstPointer;
using test::kLastOffset;
using test::kLastPointer;
using test::kLeave;
using test::kMiddle;
using test::kTurns;
using test::listing;
using test::Platform;
using test::Random;
using test::XpulpReference;

constexpr std::uint32_t kRam = test::kXpulpRam;
constexpr std::uint32_t kRamBytes = test::kXpulpRamBytes;

std::uint64_t wanted_instructions() {
  const auto* text = std::getenv("MEBOTS_LOCKSTEP_INSTRUCTIONS");
  return text == nullptr ? 300'000 : std::strtoull(text, nullptr, 10);
}

TEST(Xpulp, RandomProgramsDoTheSameOnASecondDescription) {
  constexpr int kStarts = 8;  // runs of each program, with different registers
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
    EXPECT_GT(executed[&row], 0U) << row.name;
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
    if (random.below(2) == 0) word &= 0xc1ffffffU;  // produces more words with few free bits
    if (random.below(2) == 0) word &= 0xfe0fffffU;
    if (random.below(2) == 0) word &= 0xfffff0ffU;
    // Each register contains an address in the RAM. A register that an access adds to its address contains 0. So every
    // access is inside the RAM.
    reference.x.fill(kRam + 16);
    const auto decoded = decode(word);
    const bool xpulp = decoded.encoding != nullptr && decoded.encoding->extension == Extension::xpulp;
    if (is_load(decoded.op) || is_store(decoded.op)) {
      if (xpulp && has_step_register(traits_of(decoded.op).mode)) {
        reference.x[word >> 20 & 31U] = 0;
        if (is_store(decoded.op)) reference.x[word >> 7 & 31U] = 0;
        reference.x[word >> 15 & 31U] = kRam + 16;
        if (((word >> 15 ^ word >> 20) & 31U) == 0 || ((word >> 15 ^ word >> 7) & 31U) == 0) continue;
      }
      if (decoded.op == Op::p_elw) word &= 0x000fffffU;
      if ((word >> 15 & 31U) == 0) continue;  // this access would start at address 0
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
