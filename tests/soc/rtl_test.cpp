// SPDX-License-Identifier: Apache-2.0
// Compares cycles with those measured on the RTL of CV32E40P and RI5CY (rtl/README.md).
#include "hart/observer.hpp"
#include "machine.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace mebots::soc {
namespace {

using test::Machine;

struct Measured {
  std::uint64_t instructions = 0;
  std::uint64_t cycles = 0;
  bool operator==(const Measured&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Measured& value) {
  return out << value.instructions << " instructions, " << value.cycles << " cycles";
}

using Table = std::vector<std::pair<std::string, Measured>>;  // names and values in the order of the programs

/// Returns the reference of a core from micro.csv. The columns are: name; four values of CV32E40P; the same four values
/// of RI5CY. The four values are instructions, cycles, and both divided by the number of repetitions.
Table reference(CoreKind kind) {
  const auto first = kind == CoreKind::cv32e40p ? 1U : 5U;
  std::ifstream file(MEBOTS_RTL_DIR "/micro.csv");
  Table table;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    if (fields.size() <= first || fields[first].empty()) continue;
    table.push_back({fields[0], {std::stoull(fields[first]), std::stoull(fields[first + 1])}});
  }
  return table;
}

/// Returns the records that the micro programs have stored. After a count, each record has 64 bytes: name, cycles,
/// instructions, repetitions.
Table measured(const Machine& machine) {
  Table table;
  const auto count = machine.word("results");
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto name_address = machine.word("results", 1 + 16 * i);
    std::string name;
    for (auto at = name_address;; ++at) {
      const auto c = static_cast<char>(machine.word(at & ~3U) >> (8 * (at & 3U)));
      if (c == '\0') break;
      name += c;
    }
    table.push_back({name, {machine.word("results", 3 + 16 * i), machine.word("results", 2 + 16 * i)}});
  }
  return table;
}

/// Compares the found values with the first rows of the reference.
void expect_exact(const Table& found, const Table& expected) {
  ASSERT_LE(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].first, expected[i].first);
    EXPECT_EQ(found[i].second, expected[i].second) << expected[i].first;
  }
}

TEST(Rtl, StandardMicroProgramsTakeTheCyclesOfCv32e40p) {
  // After the standard instructions, this program uses Xpulp in CORE-V encodings, which our hart does not support. So
  // it ends in its trap handler.
  Machine machine(Elf::read(MEBOTS_RTL_CV32E40P), CoreKind::cv32e40p);
  EXPECT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.word("tohost"), 0xdead0001U);
  const auto expected = reference(CoreKind::cv32e40p);
  auto found = measured(machine);
  EXPECT_EQ(expected.size(), 149U);
  ASSERT_EQ(found.size(), 139U);
  constexpr std::size_t kOverwritten = (0x704 - 4) / 64;  // the handler stores mepc in the place of this program's name
  found[kOverwritten].first = expected[kOverwritten].first;
  expect_exact(found, expected);
}

TEST(Rtl, AllMicroProgramsTakeTheCyclesOfRi5cy) {
  Machine machine(Elf::read(MEBOTS_RTL_RI5CY), CoreKind::ri5cy);
  ASSERT_EQ(machine.run(), Stop::watch);
  ASSERT_EQ(machine.word("tohost"), 1U) << "the program says that it failed";
  const auto found = measured(machine);
  EXPECT_EQ(found.size(), 143U);
  expect_exact(found, reference(CoreKind::ri5cy));
}

/// Sums the cycles of each instruction by cause, and checks them against the core's counts after each instruction.
class CauseSum final : public Observer {
 public:
  void retired(const Hart& hart, const Retired& instruction) override {
    for (const auto share : instruction.cycles.cycles) sum += share;
    for (std::size_t i = 0; i < kCycleCauses; ++i) causes[i] += instruction.cycles.cycles[i];
    const auto late = sum - static_cast<std::int64_t>(hart.counters().cycles);
    if (late < 0 || late > 3) ++wrong;  // a misaligned load has already subtracted cycles of the jump after it
  }
  std::int64_t of(CycleCause cause) const { return causes[static_cast<std::size_t>(cause)]; }

  std::int64_t sum = 0;
  std::array<std::int64_t, kCycleCauses> causes{};
  int wrong = 0;
};

/// Runs a program, and checks that the causes' cycles add up to the program's cycles.
void expect_sum(Machine& machine, CauseSum& causes) {
  machine.hart().observe(&causes);
  EXPECT_EQ(machine.run(1'000'000'000), Stop::watch);
  machine.hart().observe(nullptr);
  EXPECT_EQ(causes.sum, static_cast<std::int64_t>(machine.hart().counters().cycles));
  EXPECT_EQ(causes.of(CycleCause::base), static_cast<std::int64_t>(machine.hart().counters().instructions));
  EXPECT_EQ(causes.wrong, 0);
  EXPECT_EQ(causes.of(CycleCause::other), 0);
}

TEST(Rtl, TheCausesOfAllCyclesOfTheMicroProgramsAddUp) {
  Machine ri5cy(Elf::read(MEBOTS_RTL_RI5CY), CoreKind::ri5cy);
  CauseSum causes;
  expect_sum(ri5cy, causes);
  for (const auto cause : {CycleCause::load_use, CycleCause::jump_register, CycleCause::jump, CycleCause::branch,
                           CycleCause::multiply_divide, CycleCause::misaligned}) {
    EXPECT_GT(causes.of(cause), 0) << kCycleCauseNames[static_cast<std::size_t>(cause)];
  }
  Machine cv32e40p(Elf::read(MEBOTS_RTL_CV32E40P), CoreKind::cv32e40p);
  CauseSum others;
  expect_sum(cv32e40p, others);
  EXPECT_GT(others.of(CycleCause::system), 0) << "its CSR accesses take four cycles";
}

TEST(Rtl, TheConvolutionTakesTheCyclesOfCv32e40p) {
  Machine machine(Elf::read(MEBOTS_RTL_CONV), CoreKind::cv32e40p);
  ASSERT_EQ(machine.run(1'000'000'000), Stop::watch);
  EXPECT_EQ(measured(machine).at(0).second, (Measured{8115914, 9529787}));
}

}  // namespace
}  // namespace mebots::soc
