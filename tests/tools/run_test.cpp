// SPDX-License-Identifier: Apache-2.0
// Tests `mebots-soc run` as a user calls it: its output, the instruction at which the program ends, and the exit code.
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace mebots::soc::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Matches an output whose first line reports this number of instructions.
testing::Matcher<std::string> executes(std::uint64_t instructions) {
  return ContainsRegex(fmt::format("^instructions +{}\n", instructions));
}

TEST(Run, EndsWithTohostShiftedRightAsExitCode) {
  const auto passed = run_program("_start: la t0, tohost\nli t1, 1\nsw t1, 0(t0)\n1: j 1b");
  EXPECT_EQ(passed.exit_code, 0) << passed.err;
  const auto failed = run_program("_start: la t0, tohost\nli t1, 0x1234007\nsw t1, 0(t0)\n1: j 1b");
  EXPECT_EQ(failed.exit_code, 3) << "bits 8 to 1 of 0x...07";
  EXPECT_THAT(failed.out, HasSubstr("tohost 19087367\n"));
}

TEST(Run, PrintsCountsEnergyByComponentAndSpeed) {
  const auto run = run_program("_start: la t0, tohost\nli t1, 1\nsw t1, 0(t0)\n1: j 1b");
  EXPECT_THAT(run.out, StartsWith("instructions      4\ncycles            4\nCPI           1.000\n"));
  EXPECT_THAT(run.out, ContainsRegex("part +energy +mean power +share\n"));
  EXPECT_THAT(run.out,
              ContainsRegex("fabric_controller +[0-9.]+ pJ +[0-9.]+ mW +[0-9.]+ %  instructions of the fabric"));
  EXPECT_THAT(run.out,
              ContainsRegex("chip +[0-9.]+ [np]J +[0-9.]+ [mu]W +100.0 %  the parts above; range by [0-9]+ checks: "));
  EXPECT_THAT(run.out, ContainsRegex("no energy: .*cluster_cores"));
  EXPECT_THAT(run.out, ContainsRegex("host [0-9.]+ MIPS\n"));
  EXPECT_THAT(run.out, HasSubstr("tohost 1\n"));
}

TEST(Run, WritesTheReportAsJson) {
  const Folder folder;
  const auto run = run_tool(
      fmt::format("run {} --json {}",
                  folder.program(fmt::format("_start: la t0, tohost\nli t1, 1\nsw t1, 0(t0)\n1: j 1b\n{}", kTohost)),
                  folder / "report.json"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(read_file(folder.path() / "report.json"));
  EXPECT_EQ(report["controller"]["instructions"], 4);
  EXPECT_EQ(report["tohost"], 1);
  double sum_j = 0;
  for (const auto& energy_j : report["parts_j"]) sum_j += energy_j.get<double>();
  EXPECT_GT(sum_j, 0);
  EXPECT_NEAR(report["chip_j"].get<double>(), sum_j, 1e-12 * sum_j);
  EXPECT_NEAR(report["chip_mean_w"].get<double>() * report["time_s"].get<double>(), sum_j, 1e-12 * sum_j);
}

// Each program has three instructions (`la` consists of two) and the store under test. The code after the store must
// not run: it would store 9, which gives another exit code.
TEST(Run, EndsAtTheStoreThatSetsBit0OfTohostHoweverItIsDone) {
  const std::string_view after = "\nli t2, 9\nsw t2, 0(t0)\n1: j 1b";
  const auto ends_after = [&](std::string_view store, int instructions, int exit_code) {
    const auto run = run_program(fmt::format("_start: la t0, tohost\nli t1, 5\n{}{}", store, after));
    EXPECT_THAT(run.out, executes(instructions)) << store;
    EXPECT_EQ(run.exit_code, exit_code) << store << run.err;
  };
  ends_after("sw t1, 0(t0)", 4, 2);
  ends_after("sh t1, 0(t0)", 4, 2);
  ends_after("sb t1, 0(t0)", 4, 2);
  ends_after("sh t1, 2(t0)\nsb t1, 0(t0)", 5, 2);  // 0x00050000 ends nothing
  ends_after("sb t1, 3(t0)\nsb t1, 0(t0)", 5, 2);
  ends_after("slli t2, t1, 1\nsw t2, 0(t0)\nsw t1, 0(t0)", 6, 2);  // 10 is not an end
  ends_after("sw t0, 0(t0)\nsw t1, 0(t0)", 5, 2);                  // an address is not an end, either: it would be a
                                                                   // call to the host
  ends_after("sw t1, 4(t0)\nsw t1, 0(t0)", 5, 2);                  // the high word first: a compiler may divide a
                                                                   // 64-bit store like this
  ends_after("sw zero, 0(t0)\nsw t1, 0(t0)", 5, 2);                // storing 0 ends nothing
  ends_after("slli t1, t1, 16\nsw t1, -2(t0)", 5, 2);  // across the start of tohost: the upper half is tohost's low
                                                       // half
  ends_after("sw t1, -2(t0)\nsw t1, 0(t0)", 5, 2);     // the upper half is 0, so it is not an end
  // The misaligned store writes 0 into byte 3 of tohost, and the value into the high word.
  ends_after("slli t1, t1, 8\nsw t1, 3(t0)\nsrli t1, t1, 8\nsw t1, 0(t0)", 7, 2);
}

TEST(Run, StopsAtExactlyTheInstructionsThatItMay) {
  const std::string_view text =
      "_start: la sp, tohost\nli a1, 100000\n1: div a2, a1, a0\nlw a3, 1(sp)\nadd a4, a3, a3\nmulh a5, a4, a4\n"
      "addi a1, a1, -1\nbnez a1, 1b\n2: j 2b";
  for (const int limit : {0, 1, 2, 3, 7, 64, 65, 1000, 12345}) {
    const auto run = run_program(text, fmt::format("--max-instructions {}", limit));
    EXPECT_THAT(run.out, executes(limit));
    EXPECT_EQ(run.exit_code, 101);
    EXPECT_THAT(run.err, HasSubstr(fmt::format("limit of {} instructions reached", limit)));
  }
}

TEST(Run, WritesTheSignatureWordsEightDigitsALine) {
  const Folder folder;
  const auto program = folder.program(fmt::format(
      "_start: la t0, begin_signature\nli t1, 0xABCDEF01\nsw t1, 4(t0)\nla t0, tohost\nsw t1, 0(t0)\n1: j 1b\n"
      ".data\n.balign 4\n.globl begin_signature, end_signature\nbegin_signature: .word 3, 0, 0x12\nend_signature: "
      ".word 77\n.text\n{}",
      kTohost));
  const auto run = run_tool(fmt::format("run {} --signature {}", program, folder / "signature"));
  EXPECT_EQ(run.exit_code, 0x80) << run.err;
  EXPECT_EQ(read_file(folder / "signature"), "00000003\nabcdef01\n00000012\n");
}

TEST(Run, ExecutesFirmwareWithItsOptimisationLevelAndMemoryMap) {
  const std::string program = MEBOTS_BINARY_DIR "/firmware/own_map.elf";
  EXPECT_EQ(Elf::read(program).entry(), 0x1C040000U);
  const auto run = run_tool(fmt::format("run {} --board {}/configs/boards/ai_deck.json", program, MEBOTS_SOURCE_DIR));
  EXPECT_EQ(run.exit_code, 23) << run.out << run.err;
}

TEST(Run, NamesLinesAndCallersOfFailingFirmwareInCxx) {
  const auto run = run_tool(fmt::format("run {}/firmware/cxx.elf --board {}/configs/boards/ai_deck.json",
                                        MEBOTS_BINARY_DIR, MEBOTS_SOURCE_DIR));
  EXPECT_EQ(run.exit_code, 255) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("2 gauges, level 42"));
  EXPECT_THAT(
      run.err,
      HasSubstr("the program's own handler ended the program with exit code 255, after load access fault (mcause "
                "5, mtval 0x40000000)"));
  EXPECT_THAT(run.err, HasSubstr("in (anonymous namespace)::Gauge::read() const+0x"));
  EXPECT_THAT(run.err, HasSubstr("(main.cpp:18): "));
  EXPECT_THAT(run.err, HasSubstr("called from (anonymous namespace)::look("));
  EXPECT_THAT(run.err, HasSubstr("(main.cpp:36) < main+0x"));
}

TEST(Run, NamesCoreCauseLineAndCallersIfAClusterCoreFails) {
  for (const std::string board : {"ai_deck", "gap8"}) {
    SCOPED_TRACE(board);
    const auto run = run_tool(fmt::format("run {}/firmware/{}cluster_fault.elf --board {}/configs/boards/{}.json",
                                          MEBOTS_BINARY_DIR, board == "gap8" ? "gap8_" : "", MEBOTS_SOURCE_DIR, board));
    EXPECT_NE(run.exit_code, 0) << run.out;
    EXPECT_THAT(run.err, HasSubstr("cluster core 3: "));
    EXPECT_THAT(run.err, HasSubstr("illegal instruction (mcause 2, "));
    EXPECT_THAT(run.err, HasSubstr("in fail+0x"));
    EXPECT_THAT(run.err, HasSubstr("(main.c:9): "));
    EXPECT_THAT(run.err, HasSubstr("called from work+0x"));
  }
}

TEST(Run, EndsWithTheReasonIfAProgramWithoutTohostSpins) {
  const Folder folder;
  const auto run = run_tool("run " + folder.program("_start: nop\nforever: j forever"));
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("endless loop at pc 0x80000002 in forever, an endless jump to itself"));
  EXPECT_THAT(run.err, HasSubstr("no symbol tohost"));
}

TEST(Run, EndsWithTheReasonIfACoreCannotWakeUp) {
  const auto run = run_program("_start: nop\nwfi\n1: j 1b");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("at pc 0x80000006"));
  EXPECT_THAT(run.err, HasSubstr("no event can wake it"));
}

TEST(Run, SaysAtTheLimitWhenTheCoreSpins) {
  const auto run = run_program("_start: nop\nstuck: beq a0, a0, stuck", "--max-instructions 50");
  EXPECT_THAT(run.out, executes(50));
  EXPECT_THAT(run.err, HasSubstr("in stuck, an endless jump to itself: no enabled interrupt"));
}

struct FaultCase {
  const char* text;
  std::vector<const char*> says;
};

TEST(Run, AfterAFaultSaysPcFunctionInstructionCauseAndCallers) {
  const std::string_view frame =
      "_start: la sp, stack\ncall outer\n1: j 1b\n"
      ".globl outer, inner\n.type outer, @function\nouter: addi sp, sp, -16\nsw ra, 12(sp)\ncall inner\nlw ra, 12(sp)\n"
      "addi sp, sp, 16\nret\n.size outer, . - outer\n"
      ".type inner, @function\ninner: addi sp, sp, -16\nsw ra, 12(sp)\nli a0, 0x40000001\n{}\nret\n.size inner, . - "
      "inner\n"
      ".bss\n.balign 16\n.space 1024\nstack:\n.text\n";
  const FaultCase cases[] = {
      {".word 0xffffffff", {"illegal instruction (mcause 2, mtval 0xffffffff)", ".word 0xffffffff"}},
      {"lw a1, 3(a0)", {"load access fault (mcause 5, mtval 0x40000004)", "lw a1, 3(a0)"}},
      {"sh a1, 0(a0)", {"store access fault (mcause 7, mtval 0x40000001)", "sh a1, 0(a0)"}},
      {"ecall", {"ecall (mcause 11"}},
      {"ebreak", {"ebreak (mcause 3"}},
  };
  for (const auto& fault : cases) {
    const auto run = run_program(fmt::format(fmt::runtime(frame), fault.text));
    EXPECT_EQ(run.exit_code, 101);
    EXPECT_THAT(run.err, HasSubstr("in inner+0x")) << fault.text;
    EXPECT_THAT(run.err, HasSubstr("called from outer+0x")) << fault.text;
    EXPECT_THAT(run.err, HasSubstr("< _start+0x")) << fault.text;
    for (const auto* text : fault.says) EXPECT_THAT(run.err, HasSubstr(text));
    EXPECT_THAT(run.out, HasSubstr("mean power")) << "results are kept";
  }
}

TEST(Run, ControlRefusesAddressesAndSizesBeyond32Bits) {
  const Folder folder;
  const auto program = folder.program(fmt::format("_start: j _start\n{}", kTohost));
  write_file(folder / "commands", R"({"read": 6442450944, "size": 4}
{"read": 2147483648, "size": 4294967300}
{"read": 2147483648, "size": -1}
{"read": -4, "size": 4}
{"read": 2147483648, "size": 2}
)");
  const auto run = run_tool(fmt::format("run {} --control < {}", program, folder / "commands"));
  EXPECT_THAT(run.out, HasSubstr("read: 6442450944 must be an address"));
  EXPECT_THAT(run.out, HasSubstr("read: 4294967300 must be a size"));
  EXPECT_THAT(run.out, HasSubstr("read: -1 must be a size"));
  EXPECT_THAT(run.out, HasSubstr("read: -4 must be an address"));
  EXPECT_THAT(run.out, ContainsRegex(R"(\{"bytes":"[0-9a-f]{4}"\})"));
}

TEST(Run, ControlTellsTheExitCodeOfAProgramThatEndsByTohost) {
  const Folder folder;
  const auto program =
      folder.program(fmt::format("_start: la t0, tohost\nli t1, 7\nsw t1, 0(t0)\n1: j 1b\n{}", kTohost));
  write_file(folder / "commands", "{\"run\": 0.001}\n");
  const auto run = run_tool(fmt::format("run {} --control < {}", program, folder / "commands"));
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.out, HasSubstr("\"exit_code\":3"));
}

TEST(Run, ControlRefusesASignature) {
  const auto run = run_program("_start: j _start", "--control --signature signature.txt");
  EXPECT_EQ(run.exit_code, 102);
  EXPECT_THAT(run.err, HasSubstr("leave --console, --gdb, --page, --signature"));
}

TEST(Run, SaysThatMemoryIsProtected) {
  // If no PMP entry matches, U mode must not access memory (RISC-V privileged specification 3.7.1).
  const auto run =
      run_program("_start: la t0, user\ncsrw mepc, t0\nli t1, 0x1800\ncsrc mstatus, t1\nmret\nuser: nop\n1: j 1b",
                  "--core rv32imcu");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("physical memory protection (pmpcfg, pmpaddr) forbids this access"));
}

TEST(Run, SaysThatAnAccessReachesBeyondItsMemory) {
  const std::string_view program = "_start: li t0, 0x803ffffe\nlw t1, 0(t0)\n1: j 1b";  // RAM of 4 MiB
  for (const std::string_view core : {"", "--core rv32imcu"}) {
    const auto run = run_program(program, fmt::format("--ram 0x80000000:4M {}", core));
    EXPECT_EQ(run.exit_code, 101);
    EXPECT_THAT(run.err, HasSubstr("the 4 bytes from 0x803ffffe on do not all lie in memory ")) << core;
    EXPECT_THAT(run.err, HasSubstr("which ends at 0x803fffff")) << core;
    EXPECT_THAT(run.err, Not(HasSubstr("physical memory protection"))) << core;
  }
}

TEST(Run, NamesTheCallerOfAJumpToUnmappedMemory) {
  const auto run =
      run_program("_start: la sp, s\nli a0, 0x30000000\nsend: jalr a0\n1: j 1b\n.bss\n.space 64\ns:\n.text");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("instruction access fault (mcause 1, mtval 0x30000000)"));
  EXPECT_THAT(run.err, HasSubstr("called from send+0x2"));
}

TEST(Run, ReportsTheStackPointerAfterEndlessRecursion) {
  const auto run = run_program(
      "_start: li sp, 0x80001000\ncall deep\n1: j 1b\n.globl deep\n.type deep, @function\n"
      "deep: addi sp, sp, -16\nsw ra, 12(sp)\ncall deep\nret\n.size deep, . - deep\n.space 8192");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("in deep")) << "its stack grew over its code, or into nothing";
}

TEST(Run, ReportsAStackOutsideTheMemory) {
  const auto run = run_program(
      "_start: lui sp, 0x80000\ncall deep\n1: j 1b\n.globl deep\n.type deep, @function\n"
      "deep: addi sp, sp, -16\nsw ra, 12(sp)\ncall deep\nret\n.size deep, . - deep");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("store access fault (mcause 7, mtval 0x7ffffffc)"));
  EXPECT_THAT(run.err, HasSubstr("the stack pointer 0x7ffffff0 is outside the memory"));
}

TEST(Run, ReportsTheFirstExceptionIfItsHandlerFaults) {
  const auto run = run_program(
      "_start: la t0, handler\ncsrw mtvec, t0\nli a0, 0x40000000\nculprit: lw a1, 0(a0)\n1: j 1b\n.balign 4\n"
      "handler: nop\nagain: sw a1, 8(a0)");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("an exception in its own trap handler: store access fault"));
  EXPECT_THAT(run.err, HasSubstr("it began with load access fault (mtval 0x40000000) at pc 0x80000010 in culprit"));
}

TEST(Run, EndsIfAHandlerCallsItself) {
  const auto run = run_program("_start: la t0, handler\ncsrw mtvec, t0\necall\n.balign 4\nhandler: ecall");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("an exception in its own trap handler: ecall"));
}

TEST(Run, OnABoardEndsByItsExitRegister) {
  const Folder folder;
  const auto program = folder.program(
      "#include \"board.h\"\n_start: li t0, POWER_MANAGER_BASE\nli t1, 42\nsw t1, POWER_MANAGER_EXIT_OFFSET(t0)\n1: j "
      "1b",
      0x1c000000);
  const auto run = run_tool(fmt::format("run {} --board '{}/configs/boards/ai_deck.json'", program, MEBOTS_SOURCE_DIR));
  EXPECT_EQ(run.exit_code, 42) << run.err;
  EXPECT_THAT(run.out, HasSubstr("exit 42\n"));
}

TEST(Run, NamesTheExtensionOfAnInstructionThatTheCoreLacks) {
  struct Case {
    std::string_view instruction;
    std::string_view said;
  };
  for (const auto& [instruction, said] : std::initializer_list<Case>{
           {".word 0x0062a3af", "amoadd.w, of extension A"},
           {".word 0x1002a32f", "lr.w, of extension A"},
           {".word 0x00052007", "flw, of extension F"},
           {".word 0x02a5f553", "a double-precision operation, of extension D"},
           {".half 0x6108", "c.flw, of extension F"},
           {".word 0x0d0572d7", "vsetvli, of extension V"},
           {".word 0x00053503", "ld, of extension RV64I"},
           {".word 0x20b52533", "sh1add, of extension Zba"},
           {".word 0x60051513", "clz, of extension Zbb"},
           {".word 0x10200073", "sret, of extension S"},
           {".word 0x18002573", "the core has no register csr0x180 (0x180), or it cannot be written; it belongs to S"},
           {".word 0x00302573", "it belongs to F"},
           {".word 0x00000000", "there is no code here"},
           {".word 0xffffffff", "erased flash"},
           {".word 0x0045278b", "an instruction of Xpulp v2"}}) {
    const auto run = run_program(fmt::format("_start: nop\n.balign 4\nplace: {}\n1: j 1b", instruction));
    EXPECT_EQ(run.exit_code, 101) << instruction;
    EXPECT_THAT(run.err, HasSubstr(said)) << instruction;
    EXPECT_THAT(run.err, HasSubstr("in place")) << instruction;
  }
  const auto atomic = run_program("_start: nop\n.word 0x0062a3af");
  EXPECT_THAT(atomic.err, HasSubstr("compile with -march=rv32imc_zicsr -mabi=ilp32"));
  EXPECT_THAT(atomic.err, HasSubstr("the program was compiled for rv32i2p"));
}

TEST(Run, NamesTheExceptionIfItsHandlerDoesNotReturn) {
  const auto run =
      run_program("_start: la t0, handler\ncsrw mtvec, t0\n.word 0x0062a3af\n.balign 256\nhandler: j handler");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("endless loop"));
  EXPECT_THAT(run.err, HasSubstr("no handler has returned since illegal instruction"));
  EXPECT_THAT(run.err, HasSubstr("amoadd.w"));
}

TEST(Run, ReportsAHandlerThatCv32e40pWouldMoveWithoutABoard) {
  const std::string_view program =
      "_start: la t0, handler\ncsrw mtvec, t0\ncsrr a0, mcycle\necall\n.balign 4\nhandler: la t0, tohost\nli t1, 5\n"
      "sw t1, 0(t0)\n1: j 1b";
  const auto run = run_program(program);
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_THAT(run.err, HasSubstr("to mtvec; CV32E40P clears bits 7 to 2"));
  EXPECT_THAT(run.err, HasSubstr("the program read mcycle, which CV32E40P stops at reset"));
  const auto plain = run_program(program, "--core rv32imc");
  EXPECT_EQ(plain.exit_code, 2);
  EXPECT_EQ(plain.err, "");
  EXPECT_THAT(run_program(program, "--core rv32").err, HasSubstr("'i' is missing"));
}

}  // namespace
}  // namespace mebots::soc::test
