// SPDX-License-Identifier: Apache-2.0
// Tests programs that call the host: semihosting, system calls through tohost, and a C library with such calls.
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace mebots::soc::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Defines the macro `host OPERATION, BLOCK`, which makes a call of semihosting. The result is in a0.
constexpr std::string_view kSemihosting = R"(
    .macro host operation, block
    li a0, \operation
    la a1, \block
    .balign 16
    .option push
    .option norvc
    slli x0, x0, 31
    ebreak
    srai x0, x0, 7
    .option pop
    .endm
)";

TEST(Semihosting, PrintsWritesAndReadsFilesBelowTheFolderAndExits) {
  const Folder folder;
  std::filesystem::create_directory(folder / "shared");
  write_file(folder / "secret", "x");
  const auto program = folder.program(fmt::format(R"({}
_start: host 4, text
    host 1, to_write
    sw a0, handle, t0
    host 5, handle
    mv s0, a0
    host 2, handle
    host 1, to_read
    sw a0, handle, t0
    la t0, copy
    sw t0, handle + 4, t1
    host 6, handle
    add s0, s0, a0
    host 0xc, handle
    sw a0, length, t0
    host 4, copy
    host 1, outside
    sw a0, refused, t0
    host 0x13, refused
    addi a0, a0, 40
    sw a0, code, t0
    bnez s0, failed
    host 0x20, reason
failed: host 0x18, 0
    .data
    .balign 4
handle: .word 0, text, 6
length: .word 0
refused: .word 0
to_write: .word name, 4, 8
to_read: .word name, 0, 8
outside: .word secret, 0, 9
reason: .word 0x20026
code: .word 0
text: .asciz "hello\n"
copy: .space 16
name: .ascii "note.txt"
secret: .ascii "../secret"
    .text
)",
                                                  kSemihosting));
  const auto run = run_tool(fmt::format("run {} --host-files {}", program, folder / "shared"));
  EXPECT_THAT(run.out, StartsWith("hello\nhello\n"));
  EXPECT_EQ(read_file(folder / "shared/note.txt"), "hello\n");
  EXPECT_EQ(run.exit_code, 40 + EACCES) << run.err;
  EXPECT_THAT(run.out, HasSubstr(fmt::format("exit {}\n", 40 + EACCES)));
}

TEST(Semihosting, AnEbreakAloneIsATrap) {
  const auto run = run_program("_start: nop\n.option norvc\nebreak\n1: j 1b");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("ebreak (mcause 3"));
}

TEST(Semihosting, CostsNoTimeAndCountsNoInstruction) {
  const Folder folder;
  const auto text = [](std::string_view call) {
    return fmt::format(
        "{}\n_start: li a0, 3\nla a1, text\n.balign 16\n.option norvc\nslli x0, x0, 31\n{}\n"
        "srai x0, x0, 7\n.option rvc\nla t0, tohost\nli t1, 1\nsw t1, 0(t0)\n1: j 1b\n.data\n"
        "text: .asciz \"\\n\"\n.text\n{}",
        kSemihosting, call, kTohost);
  };
  const auto calls = run_tool("run " + folder.program(text("ebreak")));
  const auto counts = [](const std::string& out) { return out.substr(out.find("instructions"), 30); };
  EXPECT_THAT(calls.out, StartsWith("\ninstructions "));
  const auto plain = run_tool("run " + folder.program(text("nop")));
  EXPECT_EQ(std::stoi(counts(calls.out).substr(13)) + 1, std::stoi(counts(plain.out).substr(13)));
}

/// Returns a program that prints "Wow!" to the console of riscv-isa-sim. Each character is odd, like a value that ends
/// a program; the store must nevertheless print it. `store` is code that stores the command into tohost: the low word
/// is in t0, the high word in t1.
std::string console_program(std::string_view store) {
  return fmt::format(R"(
_start: la s0, text
next: lbu t0, 0(s0)
    li t1, 0x01010000
    beqz t0, end
    la t2, tohost
{}
    # done when the host has cleared the command
1:  lw t2, tohost
    lw t3, tohost + 4
    or t2, t2, t3
    bnez t2, 1b
    addi s0, s0, 1
    j next
end: la t2, tohost
    li t0, 7
    sw t0, 0(t2)
2:  j 2b
    .data
text: .asciz "Wow!"
    .text
{})",
                     store, kTohost);
}

TEST(HostConsole, PrintsWhateverOrderTheHalvesAreStoredIn) {
  const Folder folder;
  for (const std::string_view store : {"sw t0, 0(t2)\nsw t1, 4(t2)", "sw t1, 4(t2)\nsw t0, 0(t2)",
                                       "sw t0, 0(t2)\nlui t1, 0x1010\naddi t4, t2, 4\nsw t1, 0(t4)"}) {
    const auto run = run_tool("run " + folder.program(console_program(store)));
    EXPECT_THAT(run.out, StartsWith("Wow!\ninstructions ")) << store;
    EXPECT_EQ(run.exit_code, 3) << "7 >> 1" << run.err;
  }
}

TEST(HostConsole, NamesACommandThatIsNotServed) {
  const auto run = run_program(
      "_start: la t0, tohost\nli t1, 0x01000000\nsw t1, 4(t0)\n1: lw t2, 4(t0)\nbnez t2, 1b\nsw t1, 4(t0)\n"
      "2: lw t2, 4(t0)\nbnez t2, 2b\nli t1, 1\nsw t1, 0(t0)\n1: j 1b");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("command 0 to device 1 through tohost is not supported"));
  EXPECT_EQ(run.err.find("command 0"), run.err.rfind("command 0")) << "once";
}

TEST(HostConsole, AWordAfterTohostThatIsAnotherSymbolIsNoCommand) {
  const Folder folder;
  const auto program = folder.program(
      "_start: la t0, tohost\nli t1, 9\nsw t1, 4(t0)\nsw t1, 0(t0)\n1: j 1b\n.data\n.balign 64\n.globl tohost\n"
      "tohost: .word 0\nother: .word 0x01010000\n");
  EXPECT_EQ(run_tool("run " + program).exit_code, 4);
}

TEST(SystemCalls, ThroughTohostAreServedAsSpikeDoes) {
  const Folder folder;
  std::filesystem::create_directory(folder / "shared");
  const auto program = folder.program(fmt::format(R"(
    .macro proxy
    la t0, block
    sw t0, tohost, t1
    sw zero, tohost + 4, t1
1:  lw t0, fromhost
    beqz t0, 1b
    sw zero, fromhost, t1
    .endm
    .macro argument index, value
    li t0, \value
    sw t0, block + 8 * \index, t1
    .endm
_start: proxy
    lw s0, block
    argument 0, 56
    la t0, name
    sw t0, block + 16, t1
    argument 3, 9
    argument 4, 01101
    proxy
    lw s1, block
    argument 0, 64
    sw s1, block + 8, t1
    la t0, text
    sw t0, block + 16, t1
    argument 3, 6
    proxy
    argument 0, 1000
    proxy
    lw s2, block
    add s0, s0, s2
    argument 0, 93
    sw s0, block + 8, t1
    proxy
    .data
    .balign 8
block: .quad 64, 1, text, 6, 0, 0, 0, 0
    .globl fromhost
fromhost: .quad 0
text: .ascii "hello\n"
name: .asciz "note.txt"
    .text
{})",
                                                  kTohost));
  const auto run = run_tool(fmt::format("run {} --host-files {}", program, folder / "shared"));
  EXPECT_THAT(run.out, StartsWith("hello\n"));
  EXPECT_EQ(read_file(folder / "shared/note.txt"), "hello\n");
  EXPECT_EQ(run.exit_code, (6 - ENOSYS) & 0xff) << "bytes written, and no such call";
}

TEST(Semihosting, UsesTheConsoleOfATestThatControlsTheRun) {
  const Folder folder;
  const auto program = folder.program(fmt::format(R"({}
_start: host 4, text
    host 7, text
    sw a0, nothing, t0
    li s0, 10000
1:  addi s0, s0, -1
    bnez s0, 1b
    host 7, text
    sw a0, letter, t0
    host 3, letter
    host 0x20, reason
    .data
    .balign 4
reason: .word 0x20026, 7
letter: .word 0
    .globl nothing
nothing: .word 0
text: .asciz "hello\n"
    .text
)",
                                                  kSemihosting));
  write_file(folder / "commands", R"({"run": 0.00001}
{"read": "nothing", "size": 4}
{"send": "xyz"}
{"run": 0.01}
)");
  const auto run = run_tool(fmt::format("run {} --control < {}", program, folder / "commands"));
  EXPECT_EQ(run.exit_code, 7) << run.err;
  std::istringstream lines(run.out);
  std::vector<nlohmann::json> answers;
  for (std::string line; std::getline(lines, line);) answers.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(answers.size(), 4U);
  EXPECT_EQ(answers[0]["console"], "hello\n");
  EXPECT_EQ(answers[1]["bytes"], "ffffffff") << "nothing to read yet";
  EXPECT_EQ(answers[3]["console"], "x");
  EXPECT_EQ(answers[3]["exit_code"], 7);
}

TEST(HostFiles, MustBeAFolder) {
  const Folder folder;
  const auto run = run_tool(fmt::format("run {} --host-files {}", folder.program("_start: nop"), folder / "nowhere"));
  EXPECT_EQ(run.exit_code, 102);
  EXPECT_THAT(run.err, HasSubstr("--host-files"));
  EXPECT_THAT(run.err, HasSubstr("this is not a folder"));
}

/// The program uses Debian's picolibc with its own start code, linker script and printf. It is optimised for size. Its
/// memory map differs from that of the runtime.
TEST(CLibrary, PrintsAndKeepsFilesBySemihosting) {
  const Folder folder;
  std::filesystem::create_directory(folder / "shared");
  write_file(folder / "program.c", R"(
#include <stdio.h>
int main(void) {
  char line[32];
  printf("%s %d %.3f\n", "numbers", 42, 3.25);
  FILE* file = fopen("note.txt", "w");
  if (!file || fprintf(file, "line %d\n", 7) != 7 || fclose(file)) return 1;
  file = fopen("note.txt", "r");
  if (!file || !fgets(line, sizeof line, file)) return 2;
  printf("%s", line);
  return fopen("/etc/passwd", "r") || fopen("../program.c", "r") ? 3 : 9;
}
)");
  const auto command = fmt::format(
      "{} -Os -march=rv32imc -mabi=ilp32 --specs=picolibc.specs --oslib=semihost --crt0=hosted "
      "-Wl,--defsym=__flash=0x80000000 -Wl,--defsym=__flash_size=0x100000 -Wl,--defsym=__ram=0x80100000 "
      "-Wl,--defsym=__ram_size=0x100000 {} -o {}",
      MEBOTS_RISCV_GCC, folder / "program.c", folder / "program.elf");
  ASSERT_EQ(std::system(command.c_str()), 0) << "picolibc is Debian's picolibc-riscv64-unknown-elf";
  const auto run = run_tool(fmt::format("run {} --host-files {}", folder / "program.elf", folder / "shared"));
  EXPECT_THAT(run.out, StartsWith("numbers 42 3.250\nline 7\n"));
  EXPECT_EQ(run.exit_code, 9) << run.out << run.err;
}

}  // namespace
}  // namespace mebots::soc::test
