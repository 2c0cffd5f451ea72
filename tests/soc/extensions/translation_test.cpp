// SPDX-License-Identifier: Apache-2.0
// Runs random programs on cores with options. Translated code and the interpreter must agree in all registers, flags
// and counts after each of many short runs.
#include "machine.hpp"
#include "support/same_state.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace mebots::soc::test {
namespace {

constexpr unsigned kBase = 8;     // s0 contains an address in the data
constexpr unsigned kCounter = 9;  // s1 contains the loop count
constexpr unsigned kLength = 60;  // number of random instructions in a loop
constexpr unsigned kTurns = 200;  // more iterations than are needed for a translation

class Generator {
 public:
  Generator(std::uint32_t seed, Extensions core) : random_(seed), core_(core) {
    for (const auto& row : encodings()) {
      if (row.extension != Extension::standard && row.extension != Extension::xpulp && core.has(row.extension)) {
        rows_.push_back(&row);
      }
    }
  }

  /// Returns a program as text, and adds the encodings that it contains to `seen`.
  std::string program(std::set<const Encoding*>& seen) {
    std::string text = "_start: la s0, numbers\n li t0, 0x6000\n csrs mstatus, t0\n";
    for (unsigned reg = 10; reg < 32; ++reg) text += fmt::format("lw x{}, {}(s0)\n", reg, 4 * reg);
    text += fmt::format("li s1, {}\nloop:\n", kTurns);
    for (unsigned i = 0; i < kLength; ++i) {
      if (core_.has_floats() && below(12) == 0) {
        text += below(3) == 0 ? fmt::format("csrwi frm, {}\n", below(5)) : "csrwi frm, 0\n";
      }
      if (below(6) == 0) text += fmt::format("lw x{}, {}(s0)\n", 10 + below(22), 4 * below(64));
      const auto word = instruction(seen);
      text += is_compressed(word) ? fmt::format(".half 0x{:04x}\n", word) : fmt::format(".word 0x{:08x}\n", word);
    }
    text += fmt::format(
        "addi s1, s1, -1\n beqz s1, done\n j loop\ndone:\n{}.data\n.balign 256\n.space 2048\nnumbers:\n", kEnd);
    for (int i = 0; i < 64; ++i) text += fmt::format(".word 0x{:08x}\n", number());
    return text + ".space 4096\n.text\n";
  }

 private:
  std::uint32_t word() { return static_cast<std::uint32_t>(random_()); }
  std::uint32_t below(std::uint32_t count) { return word() % count; }

  /// Returns an operand, which is often a special float: zero, infinity, NaN, a subnormal or a small whole number.
  std::uint32_t number() {
    const std::array<std::uint32_t, 6> special{0, 0x7f800000, 0x7fc00000, 0x7f800001, word() & 0x7fffffU, 0x40400000};
    if (below(3) == 0) return special[below(special.size())] ^ (word() & 0x80000000U);
    return below(2) == 0 ? word() : (word() & 0x80ffffffU & ~0x7f800000U) | (110 + below(34)) << 23;
  }

  std::uint32_t instruction(std::set<const Encoding*>& seen) {
    for (;;) {
      const auto& row = *rows_[below(static_cast<std::uint32_t>(rows_.size()))];
      auto value = (word() & ~row.mask) | row.match;
      if (is_compressed(row.format)) value &= 0xffffU;
      const bool access = is_load(row.op) || is_store(row.op);
      if (access && !is_compressed(row.format)) value = (value & ~(31U << 15)) | kBase << 15;
      if (access && !is_atomic(row.op))
        value &= is_compressed(row.format) ? ~0U : is_load(row.op) ? 0x7ffffffU | 0x18000000U : 0x7fffffffU;
      const auto decoded = decode(value, core_);
      if (decoded.encoding != &row) continue;
      if (access && decoded.rs1 != kBase) continue;
      if (decoded.rd == kBase || decoded.rd == kCounter) continue;
      seen.insert(&row);
      return value;
    }
  }

  std::mt19937 random_;  // NOLINT: the same programs each time
  Extensions core_;
  std::vector<const Encoding*> rows_;
};

void compare(const std::string& isa, std::set<const Encoding*>& seen, std::uint32_t seed) {
  const auto core = read_isa(isa);
  const auto text = Generator(seed, core).program(seen);
  const auto elf = Elf::parse(assemble_file(text, 0x80000000, "-march=rv32imafc_zicsr -mabi=ilp32"), "random program");
  Machine translated(elf, MachineSettings{.options = core});
  Machine interpreted(elf, MachineSettings{.translate = false, .options = core});
  std::mt19937 random(seed);
  auto stop = Stop::limit;
  while (stop == Stop::limit) {
    const auto limit = translated.hart().counters().cycles + 1 + random() % (random() % 4 == 0 ? 20'000 : 200);
    stop = translated.run(limit);
    ASSERT_EQ(interpreted.run(limit), stop) << text;
    ASSERT_TRUE(mebots::test::same_state(translated.hart(), interpreted.hart()))
        << isa << ", seed " << seed << ", cycle " << limit << fmt::format(", pc {:x}\n", translated.hart().pc())
        << text;
  }
  EXPECT_EQ(translated.word("tohost"), 1U) << text;
  for (unsigned i = 0; i < 64; ++i) ASSERT_EQ(translated.word("numbers", i), interpreted.word("numbers", i)) << text;
  EXPECT_GT(translated.hart().code().instructions_translated(), 0U);
}

TEST(TranslatedOptions, RunAsInterpreted) {
  std::set<const Encoding*> seen;
  const std::array cores{"rv32imafc_zba_zbb_zbc_zbs", "rv32imc_zfinx", "rv32imfc"};
  for (std::uint32_t seed = 1; seed <= 24; ++seed) {
    compare(cores[seed % cores.size()], seen, seed);
    if (HasFatalFailure()) return;
  }
  for (const auto& row : encodings()) {
    if (row.extension == Extension::standard || row.extension == Extension::xpulp) continue;
    if (row.name == "c.flwsp" || row.name == "c.fswsp") continue;  // these take their address from another register
    EXPECT_TRUE(seen.contains(&row)) << row.name;
  }
}

}  // namespace
}  // namespace mebots::soc::test
