// SPDX-License-Identifier: Apache-2.0
// Tests how mebots-soc runs users' programs: system calls, RAM or a board that the user defines, and a console. Also
// tests messages, and limits that end programs.
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <regex>
#include <thread>

namespace mebots::soc::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Defines the macro `call N, A0, A1, A2`, which makes a system call. The result is in a0.
constexpr std::string_view kCall = R"(
    .macro call number, first=0, second=0, third=0
    la a0, \first
    la a1, \second
    la a2, \third
    li a7, \number
    ecall
    .endm
)";

Outcome run_user(std::string_view text, std::string_view options = {}, std::string_view end = {}) {
  const Folder folder;
  return run_tool(fmt::format("run --user {} {} {}", folder.program(fmt::format("{}\n{}", kCall, text)), options, end));
}

TEST(User, WritesAndExits) {
  const auto run = run_user(R"(
_start: call 64, 1, text, 6
    mv s0, a0
    call 93, 37
    .data
text: .ascii "hello\n")");
  EXPECT_THAT(run.out, StartsWith("hello\n"));
  EXPECT_EQ(run.exit_code, 37) << run.err;
  EXPECT_EQ(run.err, "");
}

TEST(User, ReadsStandardInputToItsEnd) {
  const Folder folder;
  write_file(folder / "input", "one\ntwo\n");
  const auto run = run_user(R"(
_start: li s1, 0
1:  call 63, 0, buffer, 3
    blez a0, 2f
    add s1, s1, a0
    mv a2, a0
    li a0, 1
    la a1, buffer
    li a7, 64
    ecall
    j 1b
2:  mv a0, s1
    li a7, 93
    ecall
    .bss
buffer: .space 16)",
                            {}, "< " + (folder / "input"));
  EXPECT_THAT(run.out, StartsWith("one\ntwo\n"));
  EXPECT_EQ(run.exit_code, 8);
}

TEST(User, FindsItsArgumentsOnTheStack) {
  const auto run = run_user(R"(
_start: lw s0, 0(sp)
    lw s1, 12(sp)
    li a0, 1
    mv a1, s1
    li a2, 5
    li a7, 64
    ecall
    lw s2, 16(sp)
    andi s3, sp, 15
    add a0, s0, s2
    add a0, a0, s3
    li a7, 93
    ecall)",
                            "one -- -two!");
  EXPECT_THAT(run.out, StartsWith("-two!"));
  EXPECT_EQ(run.exit_code, 3) << "the program's name is the first; a zero ends the list; the stack is aligned";
}

TEST(User, MovesItsHeapAndKeepsTheOldOneWhereThereIsNoMemory) {
  const auto run = run_user(R"(
_start: call 214
    mv s0, a0
    li t0, 0x4000000
    add a0, a0, t0
    mv s1, a0
    li a7, 214
    ecall
    bne a0, s1, failed
    sw a0, -4(s1)
    call 214, 0xf0000000
    bne a0, s1, failed
    call 214, 4
    bne a0, s1, failed
    la t0, last
    bltu s0, t0, failed
    call 93, 1
failed: call 93, 2
    .bss
    .space 5000
last:)");
  EXPECT_EQ(run.exit_code, 1) << run.err;
}

TEST(User, TellsThatTheConsoleIsACharacterDevice) {
  const auto run = run_user(R"(
_start: call 80, 1, status
    bnez a0, 1f
    lw a0, status + 16
    srli a0, a0, 12
1:  li a7, 93
    ecall
    .bss
    .balign 8
status: .space 104)");
  EXPECT_EQ(run.exit_code, 2) << "S_IFCHR is 2 << 12";
}

TEST(User, TimesAreSimulated) {
  const std::string_view program = R"(
_start: li t0, 100000
1:  addi t0, t0, -1
    bnez t0, 1b
    call 169, time
    call 403, 1, time + 16
    lw a0, time + 8
    lw a1, time + 24
    li t0, 1000
    divu a1, a1, t0
    sub a1, a1, a0
    sltiu a1, a1, 2
    srli a0, a0, 6
    beqz a1, failed
    li a7, 93
    ecall
failed: call 93, 0
    .bss
    .balign 8
time: .space 32)";
  const auto run = run_user(program);
  // An addition and a taken branch take 1 and 3 cycles of 10 ns. 100 000 iterations take 4 ms. The program divides the
  // microseconds by 64: 4000 / 64 = 62.
  EXPECT_EQ(run.exit_code, 62);
  EXPECT_EQ(run_user(program).exit_code, 62);
}

TEST(User, OpensFilesOnlyBelowTheFolder) {
  const Folder folder;
  write_file(folder / "note", "text");
  const std::string_view program = R"(
_start: call 1024, name, 0
    mv s0, a0
    li a7, 63
    la a1, buffer
    li a2, 9
    ecall
    li a7, 93
    ecall
    .data
name: .asciz "note"
buffer: .space 16)";
  EXPECT_EQ(run_user(program, "--host-files " + (folder / ".")).exit_code, 4);
  EXPECT_EQ(run_user(program).exit_code, (-EBADF) & 0xff) << "without a folder open fails, and so does read";
}

TEST(User, NamesACallThatIsNotServed) {
  const auto run = run_user("_start: call 220\nneg a0, a0\nli a7, 93\necall");
  EXPECT_EQ(run.exit_code, ENOSYS);
  EXPECT_THAT(run.err, HasSubstr("system call 220 (clone) is not supported and returns ENOSYS"));
}

TEST(User, WithoutTheOptionAnEcallIsAnExceptionAndTheOptionIsNamed) {
  const Folder folder;
  const auto run = run_tool("run " + folder.program(fmt::format("{}\n_start: call 64", kCall)));
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("ecall (mcause 11"));
  EXPECT_THAT(run.err,
              HasSubstr("if this ecall is system call 64 (write) of an operating system: run the program with --user"));
}

TEST(Ram, IsWhereTheOptionSays) {
  const Folder folder;
  const auto program = folder.program(
      "_start: li a0, 0x60000ffc\nsw a0, 0(a0)\nlw a1, 0(a0)\nsub a0, a0, a1\nli a7, 93\necall", 0x20000000);
  EXPECT_EQ(run_tool(fmt::format("run --user {} --ram 0x20000000:64K --ram 0x60000000:4096", program)).exit_code, 0);
  const auto less = run_tool(fmt::format("run --user {} --ram 0x20000000:64K --ram 0x60000000:2048", program));
  EXPECT_EQ(less.exit_code, 101);
  EXPECT_THAT(less.err, HasSubstr("store access fault"));
  EXPECT_THAT(less.err, HasSubstr("its memories are 0x20000000 to 0x2000ffff, 0x60000000 to 0x600007ff"));
}

TEST(Ram, GivesABoardMore) {
  const Folder folder;
  const auto program = folder.program(
      "_start: li a0, 0xa0000000\nsw a0, 0(a0)\nli t0, 0x100000\nli t1, 0x5555\n"
      "sw t1, 0(t0)\n1: j 1b");
  EXPECT_EQ(run_tool(fmt::format("run {} --board virt", program)).exit_code, 101);
  EXPECT_EQ(run_tool(fmt::format("run {} --board virt --ram 0x80000000:1G", program)).exit_code, 0);
  EXPECT_EQ(run_tool(fmt::format("run {} --board virt --ram 0xa0000000:4K", program)).exit_code, 0);
}

TEST(Ram, ThatIsNoneIsRefused) {
  const Folder folder;
  const auto program = folder.program("_start: j _start");
  for (const auto& [options, says] : std::initializer_list<std::pair<std::string, std::string>>{
           {"--ram 64M", "this is not a range of memory; give an address and a size, such as 0x80000000:64M"},
           {"--ram 0x80000000:x", "this is not a range"},
           {"--ram 0x80000000:0", "must be multiples of 4"},
           {"--ram 0xf0000000:1G", "passes the end of the 32-bit address space"},
           {"--board virt --ram 0x10000000:4K", "device uart of the board is at 0x10000000"},
           {"--max-time 5lightyears", "--max-time 5lightyears: this is not a time"},
           {"--timeout -1", "this is not a time"},
           {"--console telex", "there are stdio and pty"},
           {"argument", "which only --user passes on"}}) {
    const auto run = run_tool(fmt::format("run {} {}", program, options));
    EXPECT_EQ(run.exit_code, 102) << options;
    EXPECT_THAT(run.err, HasSubstr(says)) << options;
  }
}

TEST(Limits, OfSimulatedTimeEndTheRunThere) {
  const auto run = run_program("_start: addi a0, a0, 1\nj _start", "--max-time 2ms");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("limit of 2ms of simulated time reached (--max-time) at pc 0x8000000"));
  EXPECT_THAT(run.out, HasSubstr("time 2.000 ms"));
}

TEST(Limits, OfTheHostsTimeEndTheRun) {
  const auto start = std::chrono::steady_clock::now();
  const auto run = run_program("_start: addi a0, a0, 1\nj _start", "--timeout 300ms");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("limit of 300ms of wall time reached (--timeout)"));
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(300));
}

TEST(Limits, DoNotHideThatACoreSpinsOrSleeps) {
  EXPECT_THAT(run_program("_start: j _start", "--max-time 1s").err, HasSubstr("an endless jump to itself"));
  EXPECT_THAT(run_program("_start: wfi\nj _start", "--timeout 50s").err, HasSubstr("no event can wake it"));
}

TEST(Messages, ReportTheFirstExceptionOfAHandlerThatSleeps) {
  const auto run = run_program(
      "_start: la t0, handler\ncsrw mtvec, t0\nli a0, 0x40000000\n.globl culprit\n.type culprit, @function\n"
      "culprit: lw a1, 8(a0)\n1: j 1b\n.balign 4\n.globl handler\n.type handler, @function\nhandler: wfi\nj handler");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("no handler has returned since load access fault (mcause 5, mtval 0x40000008) at pc"));
  EXPECT_THAT(run.err, HasSubstr("in culprit: c.lw a1, 8(a0)"));
}

TEST(Messages, NameTheBoardThatHasADeviceAtTheAddress) {
  const auto run = run_program("_start: li a0, 0x10000000\nsb a0, 0(a0)");
  EXPECT_THAT(run.err, HasSubstr("0x10000000 is the uart of board virt: name it by --board"));
  EXPECT_THAT(run_program("_start: li a0, 0x30000000\nsb a0, 0(a0)").err, HasSubstr("add it: --ram 0x30000000:1M"));
}

std::string finishing(std::uint32_t word, std::string_view store = "sw") {
  return fmt::format("_start: li t0, 0x100000\nli t1, 0x{:x}\n{} t1, 0(t0)\n1: j 1b", word, store);
}

TEST(Virt, FinisherGivesTheExitCode) {
  for (const auto& [program, code] : std::initializer_list<std::pair<std::string, int>>{
           {finishing(0x5555), 0}, {finishing(0x5555, "sh"), 0}, {finishing(0x2a3333), 42}, {finishing(0x13333), 1}}) {
    const auto run = run_program(program, "--board virt");
    EXPECT_EQ(run.exit_code, code) << program;
    EXPECT_EQ(run.err, "");
  }
  const auto reset = run_program(finishing(0x7777), "--board virt");
  EXPECT_EQ(reset.exit_code, 101);
  EXPECT_THAT(reset.err, HasSubstr("requested a reset from the test finisher (0x7777), which is not modelled"));
  const auto other = run_program(finishing(0x1234), "--board virt");
  EXPECT_EQ(other.exit_code, 101);
  EXPECT_THAT(other.err, HasSubstr("ignores 0x00001234"));
}

/// A program that polls the UART and sends each byte back. The byte 'q' ends the program with exit code 3.
constexpr std::string_view kEcho = R"(
_start: li s0, 0x10000000
    li a0, '>'
    sb a0, 0(s0)
1:  lbu t0, 5(s0)
    andi t0, t0, 1
    beqz t0, 1b
    lbu a0, 0(s0)
    sb a0, 0(s0)
    li t0, 'q'
    bne a0, t0, 1b
    li t0, 0x100000
    li t1, 0x33333
    sw t1, 0(t0)
2:  j 2b
)";

TEST(Console, TakesAFileOnStandardInputTheSameWayEachTime) {
  const Folder folder;
  write_file(folder / "input", "abcq");
  const auto program = folder.program(kEcho);
  const auto command = fmt::format("run {} --board virt --console stdio < {}", program, folder / "input");
  const auto run = run_tool(command);
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.out, StartsWith(">abcq"));
  const auto counts = [](const std::string& out) { return out.substr(0, out.find("host")); };
  EXPECT_EQ(counts(run_tool(command).out), counts(run.out));
}

TEST(Console, WithoutTheOptionHasNoInput) {
  const Folder folder;
  write_file(folder / "input", "abcq");
  const auto run =
      run_tool(fmt::format("run {} --board virt --max-time 1ms < {}", folder.program(kEcho), folder / "input"));
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.out, StartsWith(">\n"));
}

TEST(Console, TakesAPipe) {
  const Folder folder;
  const auto program = folder.program(kEcho);
  const auto status = std::system(fmt::format("(sleep 0.3; printf xyq) | timeout 100 {} run {} --board virt --console "
                                              "stdio --timeout 60s > {} 2>&1",
                                              tool_path(), program, folder / "out")
                                      .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 3);
  EXPECT_THAT(read_file(folder / "out"), StartsWith(">xyq"));
}

/// Reads until the text ends with `end`, but not longer than ten seconds.
std::string read_until(int file, std::string_view end) {
  std::string text;
  for (int i = 0; i < 100 && !text.ends_with(end); ++i) {
    pollfd state{file, POLLIN, 0};
    char byte = 0;
    while (!text.ends_with(end) && ::poll(&state, 1, 100) > 0 && ::read(file, &byte, 1) == 1) text += byte;
  }
  return text;
}

TEST(Console, OfAPseudoTerminalEchoesWhatAProgramTypesThere) {
  const Folder folder;
  const auto program = folder.program(kEcho);
  std::thread run([&] {
    const auto status =
        std::system(fmt::format("timeout 100 {} run {} --board virt --console pty --timeout 60s > {} 2> "
                                "{}; echo $? > {}",
                                tool_path(), program, folder / "out", folder / "err", folder / "code")
                        .c_str());
    EXPECT_EQ(status, 0);
  });
  std::smatch found;
  std::string err;
  for (int i = 0; i < 100 && !std::regex_search(err, found, std::regex("the console is (\\S+)\n")); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    err = read_file(folder / "err");
  }
  ASSERT_EQ(found.size(), 2U) << err;
  const int terminal = ::open(found[1].str().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  EXPECT_EQ(::write(terminal, "hi", 2), 2);
  EXPECT_THAT(read_until(terminal, "hi"), testing::EndsWith("hi"));
  EXPECT_EQ(::write(terminal, "q", 1), 1);
  run.join();
  ::close(terminal);
  EXPECT_EQ(read_file(folder / "code"), "3\n");
  EXPECT_THAT(read_file(folder / "out"), StartsWith("instructions ")) << "only the report";
}

}  // namespace
}  // namespace mebots::soc::test
