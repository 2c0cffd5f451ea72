// SPDX-License-Identifier: Apache-2.0
// Tests gdb-multiarch itself, in batch mode, with `mebots-soc run --gdb 0`.
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <cstdlib>

namespace mebots::soc::test {
namespace {

using testing::HasSubstr;

constexpr std::string_view kProgram = R"(
    .globl _start, add_up, counter, finish
    .type _start, @function
_start: li sp, 0x80010000
    li s0, 3
loop: mv a0, s0
    call add_up
    addi s0, s0, -1
    bnez s0, loop
    j finish
    .size _start, . - _start
    .type add_up, @function
add_up: addi sp, sp, -16
    sw ra, 12(sp)
    la t0, counter
    lw t1, 0(t0)
    add t1, t1, a0
    sw t1, 0(t0)
    lw ra, 12(sp)
    addi sp, sp, 16
    ret
    .size add_up, . - add_up
    .type finish, @function
finish: la t0, tohost
    li t1, 5
    sw t1, 0(t0)
1:  j 1b
    .size finish, . - finish
    .data
    .balign 4
counter: .word 10
    .text
)";

/// Runs gdb commands. Contains the output of gdb and of the run.
class Debugged {
 public:
  explicit Debugged(std::string_view commands, std::string_view program = kProgram) {
    const Folder folder;
    obey(commands, folder.program(fmt::format("{}{}", program, kTohost)), "");
  }
  Debugged(std::string_view commands, const std::string& elf, const std::string& options) {
    obey(commands, elf, options);
  }

  int exit_code = -1;
  std::string gdb;
  std::string out;
  std::string err;

 private:
  void obey(std::string_view commands, const std::string& elf, const std::string& options) {
    const Folder folder;
    write_file(folder / "commands", commands);
    // mebots-soc prints its address to stderr; then gdb starts.
    write_file(folder / "script", fmt::format(R"(
export RUN_FOLDER={}
{} run {} --gdb 0 {} > {}/out 2> {}/err &
tool=$!
port=
for i in $(seq 600); do
  port=$(sed -n 's/.*127.0.0.1:\([0-9]*\).*/\1/p' {}/err)
  if [ -n "$port" ]; then break; fi
  sleep 0.05
done
timeout 60 gdb-multiarch -nx -q -batch -ex "set architecture riscv:rv32" -ex "target remote 127.0.0.1:$port" -x {}/commands {} > {}/gdb 2>&1
for i in $(seq 200); do
  kill -0 $tool 2> /dev/null || break
  sleep 0.05
done
kill $tool 2> /dev/null
wait $tool
)",
                                              folder / "", tool_path(), elf, options, folder / "", folder / "",
                                              folder / "", folder / "", elf, folder / ""));
    const auto status = std::system(("bash " + (folder / "script")).c_str());
    exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    gdb = read_file(folder / "gdb");
    out = read_file(folder / "out");
    err = read_file(folder / "err");
  }
};

/// The self-test of the cluster's runtime, with quotation marks for a shell.
const std::string kClusterProgram = "'" MEBOTS_BINARY_DIR "/firmware/cluster_selftest.elf'";
const std::string kBoard = "--board '" MEBOTS_SOURCE_DIR "/configs/boards/ai_deck.json'";

class Gdb : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("gdb-multiarch --version > /dev/null 2>&1") != 0) {
      GTEST_SKIP() << "gdb-multiarch is not installed (Debian package gdb-multiarch): scripts/setup.sh installs it";
    }
  }
};

TEST_F(Gdb, StopsAtBreakpointsShowsRegistersMemoryAndTheCaller) {
  const Debugged run(
      "break add_up\ncontinue\nprint/x $a0\nprint/x *(int*)&counter\nbacktrace 1\nup\ndown\nprint/x $mstatus\ninfo "
      "registers sp\n"
      "continue\nprint/x $a0\ndelete\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("Breakpoint 1, 0x"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 0x3"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 0xa"));
  EXPECT_THAT(run.gdb, HasSubstr("in add_up ()"));
  EXPECT_THAT(run.gdb, HasSubstr("in _start ()"));
  EXPECT_THAT(run.gdb, HasSubstr("$3 = 0x1800"));
  EXPECT_THAT(run.gdb, HasSubstr("0x8000fff0"));
  EXPECT_THAT(run.gdb, HasSubstr("$4 = 0x2"));
  EXPECT_THAT(run.gdb, HasSubstr("exited with code 02")) << "tohost 5";
  EXPECT_EQ(run.exit_code, 2) << run.err;
}

TEST_F(Gdb, StepsOneInstructionAtATime) {
  const Debugged run("print/x $pc\nstepi\nprint/x $pc\nstepi\nstepi\nprint/x $s0\nprint/x $a0\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 0x80000000"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 0x80000004"));
  EXPECT_THAT(run.gdb, HasSubstr("$3 = 0x3"));
  EXPECT_THAT(run.gdb, HasSubstr("$4 = 0x3"));
}

/// gdb itself steps through a range only if the program has source lines. Therefore this test sends the packets.
/// Register 0x20 is the pc.
TEST_F(Gdb, StepsUntilTheProgramIsOutOfARange) {
  const Debugged run(
      "maintenance packet vCont?\nstepi 2\nprint &add_up\n"
      "maintenance packet vCont;r80000006,80000016:1\nmaintenance packet p20\n"
      "maintenance packet vCont;r80000016,80000032:1\nmaintenance packet p20\n"
      "maintenance packet Z0,80000026,2\nmaintenance packet vCont;r80000006,80000032:1;c\nmaintenance packet p20\n"
      "maintenance packet z0,80000026,2\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("vCont;c;C;s;S;r"));
  EXPECT_THAT(run.gdb, HasSubstr("0x80000016 <add_up>"));
  EXPECT_THAT(run.gdb, HasSubstr("received: \"16000080\"")) << "called from the range";
  EXPECT_THAT(run.gdb, HasSubstr("received: \"10000080\"")) << "behind the call";
  EXPECT_THAT(run.gdb, HasSubstr("received: \"26000080\"")) << "a breakpoint in the range";
  EXPECT_EQ(run.exit_code, 2) << run.gdb << run.err;
}

TEST_F(Gdb, MakesASecondDebuggerWait) {
  const Debugged run(
      "shell timeout 20 gdb-multiarch -nx -q -batch -ex 'set architecture riscv:rv32' -ex \"target remote 127.0.0.1:"
      "$(sed -n 's/.*127.0.0.1:\\([0-9]*\\).*/\\1/p' \"$RUN_FOLDER/err\")\" 2>&1\n"
      "print/x $pc\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("another debugger is connected"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 0x80000000"));
  EXPECT_EQ(run.exit_code, 2) << run.gdb << run.err;
}

TEST_F(Gdb, StopsWhereAWatchedVariableChanges) {
  const Debugged run("watch *(int*)&counter\ncontinue\ncontinue\nprint *(int*)&counter\ndelete\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("Hardware watchpoint 1"));
  EXPECT_THAT(run.gdb, HasSubstr("Old value = 10\nNew value = 13"));
  EXPECT_THAT(run.gdb, HasSubstr("Old value = 13\nNew value = 15"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 15"));
}

TEST_F(Gdb, StopsWhereAnAtomicOperationStores) {
  const Folder folder;
  const auto program = folder.program(fmt::format(R"(
_start: .option arch, +a
    la t0, word
    li t1, 5
    lr.w t2, (t0)
    amoadd.w t2, t1, (t0)
    la t0, tohost
    li t1, 1
    sw t1, 0(t0)
1:  j 1b
    .balign 4
word: .word 7
{})",
                                                  kTohost));
  const Debugged run("watch *(int*)&word\ncontinue\nprint *(int*)&word\ndelete\ncontinue\n", program,
                     "--core rv32imac");
  EXPECT_THAT(run.gdb, HasSubstr("Old value = 7\nNew value = 12"));
}

TEST_F(Gdb, ChangesRegistersMemoryAndCode) {
  const Debugged run(
      "set *(int*)&counter = 100\nbreak *finish\ncontinue\nprint *(int*)&counter\nset $t6 = 0x55\nprint/x $t6\n"
      "stepi\nstepi\nstepi\nset $t1 = 9\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 106"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 0x55"));
  EXPECT_EQ(run.exit_code, 4) << "tohost 9\n" << run.gdb;
}

TEST_F(Gdb, ReportsCyclesAndEnergy) {
  const Debugged run("stepi\nstepi\nmonitor cycles\nmonitor energy\nmonitor help\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("2 cycles, 2 instructions"));
  EXPECT_THAT(run.gdb, HasSubstr("fabric_controller "));
  EXPECT_THAT(run.gdb, HasSubstr("monitor commands: callers, cycles"));
}

TEST_F(Gdb, ReportsTheCallersFromRaAndTheStack) {
  const Debugged run("break *inner\ncontinue\nmonitor callers\nkill\n", R"(
    .globl _start, outer, inner
    .type _start, @function
_start: li sp, 0x80010000
    call outer
1:  j 1b
    .size _start, . - _start
    .type outer, @function
outer: addi sp, sp, -16
    sw ra, 12(sp)
    call inner
    lw ra, 12(sp)
    addi sp, sp, 16
    ret
    .size outer, . - outer
    .type inner, @function
inner: nop
    addi t1, zero, 1
    addi t2, zero, 2
    ret
    .size inner, . - inner
)");
  EXPECT_THAT(run.gdb, HasSubstr("inner < outer+0x"));
  EXPECT_THAT(run.gdb, HasSubstr(" < _start+0x"));
}

TEST_F(Gdb, ContinuesTheRunWithTheSameCountsAfterItDisconnects) {
  const Folder folder;
  const auto plain = run_tool("run " + folder.program(fmt::format("{}{}", kProgram, kTohost)));
  const Debugged run("break add_up\ncontinue\ndetach\n");
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(run.out.substr(0, run.out.find("host")), plain.out.substr(0, plain.out.find("host")));
}

TEST_F(Gdb, KillsTheRun) {
  const Debugged run("break add_up\ncontinue\nkill\n");
  EXPECT_EQ(run.exit_code, 101);
  EXPECT_THAT(run.err, HasSubstr("stopped by the debugger at pc 0x"));
}

TEST_F(Gdb, KillsTheRunOfAProgramWhoseTimerNeverStops) {
  const Folder folder;
  const auto program = folder.program(
      "_start: li a0, 0x1B200400\nli a1, 1000\nsw a1, 16(a0)\nli a1, 0x15\nsw a1, 0(a0)\nspin: j spin\n", 0x1C000000);
  const Debugged run("stepi 8\nkill\n", program, "--board '" MEBOTS_SOURCE_DIR "/configs/boards/gap8.json'");
  EXPECT_EQ(run.exit_code, 101) << run.gdb;
  EXPECT_THAT(run.err, HasSubstr("stopped by the debugger at pc 0x1c0000"));
}

TEST_F(Gdb, SeesAFaultBeforeTheRunEnds) {
  const Debugged run("continue\nprint/x $a0\nbacktrace 1\ncontinue\n",
                     ".globl bad\n_start: li sp, 0x80010000\ncall bad\n.type bad, @function\nbad: lui a0, 0x40000\n"
                     "lw a1, 0(a0)\nret\n.size bad, . - bad\n");
  EXPECT_THAT(run.gdb, HasSubstr("SIGSEGV"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 0x40000000"));
  EXPECT_THAT(run.gdb, HasSubstr("in bad ()"));
  EXPECT_EQ(run.exit_code, 101);
}

TEST_F(Gdb, InterruptsARunningProgram) {
  // A timer sends SIGINT to gdb, as Ctrl-C in a terminal does.
  const Debugged run(
      "python\nimport threading, os, signal, time\n"
      "threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\nend\n"
      "continue\nprint/x $pc\nkill\n",
      ".globl spin\n_start: nop\nspin: j spin\n");
  EXPECT_THAT(run.gdb, HasSubstr("SIGINT"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 0x80000002"));
  EXPECT_EQ(run.exit_code, 101);
}

TEST_F(Gdb, ShowsTheClustersCoresAsThreadsAndLeavesTheirCountsAlone) {
  const Debugged run(
      "info threads\nbreak meet\ncontinue\ncontinue\ncontinue\ncontinue\ncontinue\ncontinue\ncontinue\ncontinue\n"
      "info threads\ndelete\nset $before = $pc\nstepi\nprint $pc != $before\nthread 9\nprint $mhartid\nbacktrace 2\n"
      "thread 1\nmonitor cycles\ncontinue\n",
      kClusterProgram, kBoard);
  EXPECT_THAT(run.gdb, HasSubstr("* 1    Thread 1 (fabric controller) "));
  EXPECT_THAT(run.gdb, HasSubstr("  9    Thread 9 (cluster core 7, off) "));
  for (int thread = 2; thread <= 9; ++thread) {
    EXPECT_THAT(run.gdb, HasSubstr(fmt::format("Thread {} hit Breakpoint 1, meet", thread)));
  }
  EXPECT_THAT(run.gdb, HasSubstr("* 9    Thread 9 (cluster core 7)"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 1"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 7"));
  EXPECT_THAT(run.gdb, HasSubstr("#1  meet (argument=0x8)"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto plain = run_tool(fmt::format("run {} {}", kClusterProgram, kBoard));
  EXPECT_EQ(run.out.substr(0, run.out.find("host")), plain.out.substr(0, plain.out.find("host")));
}

TEST_F(Gdb, StopsTheCoreOfTheClusterThatChangesAWatchedVariable) {
  const Debugged run(
      "watch *((int*)&seen + 3)\ncontinue\ninfo threads\nprint/x $mhartid\nprint *((int*)&seen + 3)\nset $pc = $pc + "
      "4\nkill\n",
      kClusterProgram, kBoard);
  EXPECT_THAT(run.gdb, HasSubstr("Old value = 0\nNew value = 20"));
  EXPECT_THAT(run.gdb, HasSubstr("Thread 1 (fabric controller, asleep)"));
  EXPECT_THAT(run.gdb, HasSubstr("* 5    Thread 5 (cluster core 3)"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 0x3"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 20"));
  EXPECT_THAT(run.gdb, HasSubstr("Could not write register \"pc\""));
  EXPECT_EQ(run.exit_code, 101) << "killed while a core of the cluster runs";
  EXPECT_THAT(run.err, HasSubstr("stopped by the debugger at cluster core 3, pc 0x"));
}

TEST_F(Gdb, ShowsWhichCoreOfTheClusterFaulted) {
  const Debugged run("break meet\ncontinue\ncontinue\nset $sp = 0x1000\ndelete\ncontinue\ninfo threads\ncontinue\n",
                     kClusterProgram, kBoard);
  EXPECT_THAT(run.gdb, HasSubstr("Thread 3 received signal SIGSEGV"));
  EXPECT_THAT(run.gdb, HasSubstr("* 3    Thread 3 (cluster core 1)"));
  EXPECT_THAT(run.err, HasSubstr("cluster core 1: trap without a handler: store access fault"));
  EXPECT_EQ(run.exit_code, 101);
}

/// If gdb changes nothing, the same instruction is reached again with the same state.
TEST_F(Gdb, ReverseStepGoesBackByOneInstruction) {
  const Debugged run(
      "stepi 5\nprint/x $pc\nprint/x $sp\nstepi\nprint/x $sp\nreverse-stepi\nprint/x $pc\n"
      "print/x $sp\nmonitor cycles\nreverse-stepi 3\nmonitor cycles\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 0x80000016")) << "add_up";
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 0x80010000"));
  EXPECT_THAT(run.gdb, HasSubstr("$3 = 0x8000fff0"));
  EXPECT_THAT(run.gdb, HasSubstr("$4 = 0x80000016"));
  EXPECT_THAT(run.gdb, HasSubstr("$5 = 0x80010000"));
  EXPECT_THAT(run.gdb, HasSubstr(", 5 instructions"));
  EXPECT_THAT(run.gdb, HasSubstr(", 2 instructions"));
  EXPECT_THAT(run.gdb, HasSubstr("exited with code 02"));
  EXPECT_EQ(run.exit_code, 2) << run.err;
}

TEST_F(Gdb, ReverseContinueStopsAtTheLastBreakpointThenAtTheBegin) {
  const Debugged run(
      "break add_up\nbreak *finish\ncontinue\ncontinue\ncontinue\ncontinue\n"
      "reverse-continue\nprint $a0\nreverse-continue\nprint $a0\nreverse-continue\nprint "
      "$a0\nreverse-continue\nprint/x "
      "$pc\nmonitor cycles\ndelete\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("in finish ()"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 1"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 2"));
  EXPECT_THAT(run.gdb, HasSubstr("$3 = 3"));
  EXPECT_THAT(run.gdb, HasSubstr("No more reverse-execution history"));
  EXPECT_THAT(run.gdb, HasSubstr("$4 = 0x80000000"));
  EXPECT_THAT(run.gdb, HasSubstr("0 cycles, 0 instructions"));
  EXPECT_EQ(run.exit_code, 2) << run.err;
}

TEST_F(Gdb, ReverseContinueUndoesTheLastStoreToAWatchedWord) {
  const Debugged run(
      "break *finish\ncontinue\nprint *(int*)&counter\nwatch *(int*)&counter\nreverse-continue\nprint *(int*)&counter\n"
      "print/x $t1\ndelete\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 16"));
  EXPECT_THAT(run.gdb, HasSubstr("Old value = 16"));
  EXPECT_THAT(run.gdb, HasSubstr("New value = 15"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 15"));
  EXPECT_THAT(run.gdb, HasSubstr("$3 = 0x10")) << "the sum is there, and not stored";
  EXPECT_EQ(run.exit_code, 2) << run.err;
}

/// The run has two million instructions, so the debugger saves several states.
TEST_F(Gdb, ReverseContinueReachesAPlaceFarBack) {
  const Debugged run(
      "break *early\nbreak *late\ncontinue\ncontinue\nmonitor cycles\nreverse-continue\nmonitor cycles\n"
      "print $s0\ndelete\ncontinue\n",
      R"(
    .globl _start, early, late
_start: li s0, 7
early: li s0, 1000000
1:  addi s0, s0, -1
    bnez s0, 1b
late: la t0, tohost
    li t1, 7
    sw t1, 0(t0)
2:  j 2b
)");
  EXPECT_THAT(run.gdb, HasSubstr(", 2000003 instructions")) << "li s0, 1000000 is two";
  EXPECT_THAT(run.gdb, HasSubstr(", 1 instructions"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = (void *) 0x7"));
  EXPECT_EQ(run.exit_code, 3) << run.err;
}

TEST_F(Gdb, ReverseStepLeavesAFault) {
  const Debugged run("continue\nprint/x $pc\nmonitor cycles\nreverse-stepi\nmonitor cycles\nprint $a0\nkill\n", R"(
    .globl _start
_start: li a0, 5
    li a0, 6
    lw a1, 0(zero)
    j .
)");
  EXPECT_THAT(run.gdb, HasSubstr(", 2 instructions"));
  EXPECT_THAT(run.gdb, HasSubstr(", 1 instructions"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 5"));
}

TEST_F(Gdb, MonitorGoesToSavedPlacesAndToTheStart) {
  const Debugged run(
      "break finish\nbreak add_up\ncontinue\nmonitor save first\ncontinue\nprint $a0\nmonitor restore first\n"
      "maintenance flush register-cache\nprint $a0\nprint *(int*)&counter\nmonitor restore second\nmonitor reset\n"
      "maintenance flush register-cache\nprint/x $pc\nmonitor restore first\ndelete\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("saved as first"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 2"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 3"));
  EXPECT_THAT(run.gdb, HasSubstr("$3 = 10"));
  EXPECT_THAT(run.gdb, HasSubstr("there is no saved state 'second'"));
  EXPECT_THAT(run.gdb, HasSubstr("$4 = 0x80000000"));
  EXPECT_THAT(run.gdb, HasSubstr("there is no saved state 'first'")) << "a reset forgets them";
  EXPECT_EQ(run.exit_code, 2) << run.err;
}

constexpr std::string_view kPrinter = R"(
    .globl _start, finish
_start: li s0, 0x10000000
    li a0, 'A'
    sb a0, 0(s0)
    li a0, 'B'
    sb a0, 0(s0)
finish: la t0, tohost
    li t1, 3
    sw t1, 0(t0)
1:  j 1b
)";

/// After a step, the output of the instruction is complete, although the next instruction has not begun.
TEST_F(Gdb, WhatAStepPrintedIsNotPrintedAgain) {
  const Folder folder;
  const auto elf = folder.program(fmt::format("{}{}", kPrinter, kTohost));
  const Debugged run(
      "stepi 3\nmonitor save printed\nmonitor restore printed\nmaintenance flush register-cache\nprint/x $pc\n"
      "reverse-stepi 2\ncontinue\n",
      elf, "--board virt");
  EXPECT_THAT(run.gdb, HasSubstr("saved as printed"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 0x8000000c")) << "after the first store";
  EXPECT_THAT(run.out, HasSubstr("AB"));
  EXPECT_THAT(run.out, testing::Not(HasSubstr("AA")));
  EXPECT_EQ(run.exit_code, 1) << run.err;
}

/// A replay does not print the text of the console again. A change by gdb ends the history.
TEST_F(Gdb, AReplayPrintsNothingAgainAndAChangeEndsTheHistory) {
  const Folder folder;
  const auto elf = folder.program(fmt::format("{}{}", kPrinter, kTohost));
  const Debugged run(
      "break *finish\ncontinue\nreverse-stepi 3\nprint/c $a0\ncontinue\nreverse-stepi\nset var $a0 = "
      "67\nreverse-stepi\n"
      "print/c $a0\ndelete\ncontinue\n",
      elf, "--board virt");
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 65 'A'"));
  EXPECT_THAT(run.gdb, HasSubstr("No more reverse-execution history"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 67 'C'"));
  EXPECT_THAT(run.out, HasSubstr("ABC")) << "C is the changed byte";
  EXPECT_EQ(run.exit_code, 1) << run.err;
}

/// The place was saved before gdb changed s1, so it belongs to the unchanged run. It must not be restored in the
/// changed run, although the count of instructions is the same there.
TEST_F(Gdb, AChangeMakesSavedPlacesUnreachable) {
  const Debugged run(
      "break *early\nbreak *late\ncontinue\ncontinue\nmonitor save place\nreverse-continue\nset var $s1 = 99\n"
      "continue\nprint $s1\nmonitor restore place\nmonitor save again\nmonitor restore again\ndelete\ncontinue\n",
      R"(
    .globl _start, early, late
_start: li s0, 7
early: li s0, 1000000
1:  addi s0, s0, -1
    bnez s0, 1b
late: la t0, tohost
    li t1, 7
    sw t1, 0(t0)
2:  j 2b
)");
  EXPECT_THAT(run.gdb, HasSubstr("saved as place"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 99"));
  EXPECT_THAT(run.gdb, HasSubstr("the history does not reach 'place'"));
  EXPECT_THAT(run.gdb, HasSubstr("at again;")) << "the new run has a history of its own";
  EXPECT_EQ(run.exit_code, 3) << run.err;
}

/// Writes without an effect: equal values, an empty write (gdb uses it to check whether packet X is supported), and
/// refused writes.
TEST_F(Gdb, AWriteThatChangesNothingKeepsTheHistory) {
  const Debugged run(
      "break *finish\ncontinue\nset var $s0 = $s0\nset var $pc = $pc\nset var *(int*)&counter = 16\n"
      "maintenance packet M40000000,4:01000000\nmaintenance packet X80000000,0:\nmaintenance packet P7fff=01000000\n"
      "reverse-stepi\nprint $pc != &finish\ndelete\ncontinue\n");
  EXPECT_THAT(run.gdb, HasSubstr("received: \"OK\""));
  EXPECT_THAT(run.gdb, HasSubstr("received: \"E01\""));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 1"));
  EXPECT_THAT(run.gdb, testing::Not(HasSubstr("No more reverse-execution history")));
  EXPECT_EQ(run.exit_code, 2) << run.gdb << run.err;
}

/// The watched element of `seen` belongs to core 3. After this core's store, another core is executed.
TEST_F(Gdb, ReverseContinueStopsTheCoreOfTheClusterThatStored) {
  const Debugged run(
      "watch *((int*)&seen + 3)\ncontinue\ndelete\nstepi 2\nwatch *((int*)&seen + 3)\nthread 1\nreverse-continue\n"
      "info threads\nprint/x $mhartid\nprint *((int*)&seen + 3)\nkill\n",
      kClusterProgram, kBoard);
  EXPECT_THAT(run.gdb, HasSubstr("Old value = 20\nNew value = 0"));
  EXPECT_THAT(run.gdb, HasSubstr("* 5    Thread 5 (cluster core 3)"));
  EXPECT_THAT(run.gdb, HasSubstr("$1 = 0x3"));
  EXPECT_THAT(run.gdb, HasSubstr("$2 = 0"));
}

}  // namespace
}  // namespace mebots::soc::test
