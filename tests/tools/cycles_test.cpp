// SPDX-License-Identifier: Apache-2.0
//
// Tests --report, --coverage, --pipeline.
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>

namespace mebots::soc::test {
namespace {

using Report = nlohmann::json;
using testing::HasSubstr;

std::int64_t sum_of(const Report& causes) {
  std::int64_t sum = 0;
  for (const auto& cycles : causes) sum += cycles.get<std::int64_t>();
  return sum;
}

/// Checks that the cycles of the causes add up to the cycles of their function or core. Also checks that the cycles of
/// all functions add up to the cycles of their core.
void expect_sums(const Report& hart) {
  EXPECT_EQ(sum_of(hart["causes"]), hart["cycles"]);
  EXPECT_FALSE(hart["causes"].contains("other"));
  EXPECT_EQ(hart["causes"]["base"], hart["instructions"]);
  std::int64_t cycles = 0;
  for (const auto& function : hart["functions"]) {
    EXPECT_EQ(sum_of(function["causes"]), function["cycles"]) << function["name"];
    cycles += function["cycles"].get<std::int64_t>();
  }
  EXPECT_EQ(cycles, hart["cycles"]);
}

TEST(CyclesByCause, OfACorePartsAddUpToItsCycles) {
  const Folder folder;
  const auto program = folder.program(fmt::format(R"(
_start: li t0, 100
1:  la t1, word
    lw t2, 0(t1)
    add t3, t3, t2
    div t4, t3, t0
    jal ra, leaf
    addi t0, t0, -1
    bnez t0, 1b
    la t0, tohost
    li t1, 1
    sw t1, 0(t0)
2:  j 2b
    .type leaf, @function
leaf: ret
    .size leaf, . - leaf
word: .word 7
{})",
                                                  kTohost));
  const auto run = run_tool(fmt::format("run {} --report {}", program, folder / "report.json"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto report = Report::parse(read_file(folder / "report.json"));
  ASSERT_EQ(report["harts"].size(), 1U);
  const auto& hart = report["harts"][0];
  expect_sums(hart);
  EXPECT_EQ(hart["cycles"], report["controller"]["cycles"]);
  EXPECT_EQ(hart["causes"]["load_use"], 100) << "add needs what lw loads";
  EXPECT_EQ(hart["causes"]["branch"], 99 * 2) << "bnez is taken 99 times";
}

TEST(CyclesByCause, OfAClusterPartsAddUpToTheCyclesOfEachCore) {
  const Folder folder;
  const auto run =
      run_tool(fmt::format("run {}/firmware/cluster_selftest.elf --board {}/configs/boards/ai_deck.json --report {}",
                           MEBOTS_BINARY_DIR, MEBOTS_SOURCE_DIR, folder / "report.json"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto report = Report::parse(read_file(folder / "report.json"));
  ASSERT_EQ(report["harts"].size(), 9U) << "the fabric controller and eight cores";
  std::int64_t cluster = 0;
  std::int64_t conflicts = 0;
  for (const auto& hart : report["harts"]) {
    expect_sums(hart);
    if (hart["hart"] == 0) {
      EXPECT_EQ(hart["cycles"], report["controller"]["cycles"]);
      continue;
    }
    cluster += hart["cycles"].get<std::int64_t>();
    conflicts += hart["causes"].value("bank_conflict", 0);
  }
  EXPECT_EQ(cluster, report["cluster"]["cycles"]);
  std::int64_t of_banks = 0;
  for (const auto& bank : report["banks"]) of_banks += bank["conflict_cycles"].get<std::int64_t>();
  EXPECT_EQ(of_banks, conflicts);
  EXPECT_GT(conflicts, 0);
}

constexpr std::string_view kLines = R"(
    .file 1 "app/main.c"
    .globl _start
    .type _start, @function
_start: .loc 1 10
    li t0, 3
1:  .loc 1 11
    addi t0, t0, -1
    .loc 1 12
    bnez t0, 1b
    .loc 1 13
    beqz zero, 2f
    .loc 1 14
    nop
2:  .loc 1 15
    la t0, tohost
    li t1, 1
    sw t1, 0(t0)
3:  j 3b
    .size _start, . - _start
)";

TEST(Coverage, CountsLinesFunctionsAndBranches) {
  const Folder folder;
  const auto program = folder.program(fmt::format("{}{}", kLines, kTohost));
  const auto run = run_tool(fmt::format("run {} --coverage {}", program, folder / "lcov.info"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto text = read_file(folder / "lcov.info");
  EXPECT_THAT(text, HasSubstr("app/main.c\n"));
  EXPECT_THAT(text, HasSubstr("FN:10,_start\nFNDA:1,_start\nFNF:1\nFNH:1\n"));
  EXPECT_THAT(text, HasSubstr("BRDA:12,0,0,2\nBRDA:12,0,1,1\nBRDA:13,0,0,1\nBRDA:13,0,1,0\n"));
  EXPECT_THAT(text, HasSubstr("DA:10,1\nDA:11,3\nDA:12,3\nDA:13,1\nDA:14,0\nDA:15,1\n"));
  EXPECT_THAT(text, HasSubstr("LF:6\nLH:5\nend_of_record\n"));
}

/// Compilers write such a line table for optimised code: line 10 begins at an address whose code belongs to line 30.
TEST(Coverage, CountsStatementsWithoutCodeOfTheirOwn) {
  constexpr std::string_view kOptimised = R"(
    .file 1 "main.c"
    .type _start, @function
_start: .loc 1 10
    .loc 1 30 is_stmt 0
    li t0, 2
1:  .loc 1 11 is_stmt 1
    .loc 1 30 is_stmt 0
    addi t0, t0, -1
    bnez t0, 1b
    .loc 1 15 is_stmt 1
    la t0, tohost
    li t1, 1
    sw t1, 0(t0)
3:  j 3b
    .size _start, . - _start
)";
  const Folder folder;
  const auto program = folder.program(fmt::format("{}{}", kOptimised, kTohost));
  const auto run = run_tool(fmt::format("run {} --coverage {}", program, folder / "lcov.info"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto text = read_file(folder / "lcov.info");
  EXPECT_THAT(text, HasSubstr("FN:10,_start\nFNDA:1,_start\n"));
  EXPECT_THAT(text, HasSubstr("DA:10,1\nDA:11,2\nDA:15,1\n"));
}

TEST(Coverage, OfALineThatEndsBeyondAllCodeEndsWithTheProgram) {
  // A line table of DWARF version 2, encoded as DWARF 5, section 6.2, describes. Line 1 reaches from _start to the last
  // address.
  constexpr std::string_view kDamaged = R"(
_start: la t0, tohost
    li t1, 1
    beqz t1, 1f
    sw t1, 0(t0)
1:  j 1b
    .section .debug_line, "", @progbits
    .4byte 9f - 8f
8:  .2byte 2
    .4byte 7f - 6f
6:  .byte 1, 1, -5, 14, 10, 0, 1, 1, 1, 1, 0, 0, 0, 1, 0
    .asciz "main.c"
    .byte 0, 0, 0, 0
7:  .byte 0, 5, 2
    .4byte _start
    .byte 1, 2
    .uleb128 0x7fffffff
    .byte 0, 1, 1
9:
)";
  const Folder folder;
  const auto program = folder.program(fmt::format("{}{}", kDamaged, kTohost));
  const auto run = run_tool(fmt::format("run {} --coverage {}", program, folder / "lcov.info"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(read_file(folder / "lcov.info"), HasSubstr("BRDA:1,0,0,0\nBRDA:1,0,1,1\n"));
}

TEST(Coverage, WithoutLineNumbersIsRefused) {
  const Folder folder;
  const auto program = folder.program(fmt::format("_start: j _start\n{}", kTohost));
  const auto run = run_tool(fmt::format("run {} --coverage {}", program, folder / "lcov.info"));
  EXPECT_EQ(run.exit_code, 102);
  EXPECT_THAT(run.err, HasSubstr("has no line numbers: compile with -g"));
}

TEST(Pipeline, ShowsStagesThatOverlapAndStalls) {
  const Folder folder;
  const auto program = folder.program(fmt::format(R"(
_start: .option norvc
    la t0, tohost
    lw t1, 4(t0)
    addi t1, t1, 1
    sw t1, 0(t0)
1:  j 1b
{})",
                                                  kTohost));
  const auto run = run_tool(fmt::format("run {} --pipeline {}", program, folder / "kanata.log"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto text = read_file(folder / "kanata.log");
  EXPECT_TRUE(text.starts_with("Kanata\t0004\nC=\t0\nI\t0\t0\t0\n")) << text.substr(0, 80);
  EXPECT_THAT(text, HasSubstr("\t1\tload_use 1\n")) << "addi waits for lw";
  EXPECT_THAT(text, HasSubstr("R\t4\t4\t0\n")) << "the store retires";
}

}  // namespace
}  // namespace mebots::soc::test
