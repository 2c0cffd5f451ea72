// SPDX-License-Identifier: Apache-2.0
// Tests that invalid input is rejected before the run: exit code 102, a reason, and no result.
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace mebots::soc::test {
namespace {

using testing::HasSubstr;

constexpr std::string_view kOk = "_start: la t0, tohost\nli t1, 1\nsw t1, 0(t0)\n1: j 1b\n";

class BadInput : public testing::Test {
 protected:
  BadInput() : program_(folder_.program(fmt::format("{}{}", kOk, kTohost))) {}

  void expect_refused(const std::string& arguments, std::string_view reason) {
    const auto run = run_tool(arguments);
    EXPECT_EQ(run.exit_code, 102) << arguments << run.out << run.err;
    EXPECT_THAT(run.out + run.err, HasSubstr(std::string(reason))) << arguments;
    EXPECT_EQ(run.out.find("instructions "), std::string::npos) << "nothing ran: " << arguments;
  }
  /// Returns the valid program with some bytes changed.
  std::string damaged(std::size_t at, const std::string& bytes) {
    auto text = read_file(program_);
    text.replace(at, bytes.size(), bytes);
    write_file(folder_ / "damaged.elf", text);
    return "run " + (folder_ / "damaged.elf");
  }

  Folder folder_;
  std::string program_;
};

TEST_F(BadInput, AnUnknownBoardListsThoseThatThereAre) {
  expect_refused(fmt::format("run {} --board aideck", program_),
                 "--board aideck: there is no such board or file. MEbots has the boards ai_deck, flight_controller, "
                 "gap8, gap8_bare, "
                 "pulp_open, ri5cy");
}

TEST_F(BadInput, IsRefusedOnTheCommandLine) {
  expect_refused("", "");
  expect_refused("run", "mebots-soc: program is required");
  expect_refused("walk x", "mebots-soc: ");
  expect_refused("run " + program_ + " --max-instructions many", "'many' is not a whole number from 0 on");
  expect_refused("run " + program_ + " --max-instructions -1",
                 "mebots-soc: --max-instructions: '-1' is not a whole number from 0 on. `mebots-soc run --help`");
  expect_refused("run " + program_ + " --devices nope", "mebots-soc: --devices nope: this is not a folder");
  expect_refused("run " + program_ + " --devices " + program_, "this is not a folder");
  expect_refused("run " + program_ + " --gdb 65536", "");
  expect_refused("run " + program_ + " --trace-cycles", "--trace FILE");
  expect_refused("run ''", "empty file name");
  for (const auto* option : {"--board", "--signature", "--trace", "--profile", "--power-trace", "--json", "--page"}) {
    expect_refused(fmt::format("run {} {} ''", program_, option), fmt::format("{} has an empty file name", option));
  }
}

TEST_F(BadInput, IsRefusedIfTheFlashFileOrTheFlashIsMissing) {
  expect_refused(fmt::format("run {} --board gap8 --flash /nowhere", program_),
                 "--flash /nowhere: this is not a readable file");
  expect_refused(fmt::format("run {} --board gap8 --flash /dev/zero", program_),
                 "--flash /dev/zero: this is not a readable file");
  expect_refused(fmt::format("run {} --board ri5cy --flash {}", program_, folder_ / "flash"),
                 "this is not a readable file");
  write_file(folder_ / "flash", "x");
  expect_refused(fmt::format("run {} --board ri5cy --flash {}", program_, folder_ / "flash"),
                 "board ri5cy has no device of kind gap8_udma");
}

TEST_F(BadInput, IsRefusedIfPicturesAreMissingOrDoNotFitTheCamera) {
  const auto with = [&](std::string_view board) {
    return fmt::format("run {} --board {} --pictures {}", program_, board, folder_ / ".");
  };
  expect_refused(fmt::format("run {} --board gap8 --pictures /nowhere", program_), "this is not a readable folder");
  expect_refused(with("gap8"), "there is no .png or .pgm file");
  write_file(folder_ / "a.pgm", "P2 1 1 255 0");
  expect_refused(with("gap8"), "a.pgm: this is not a binary PGM");
  write_file(folder_ / "a.pgm", "P5\n324 243 255\n" + std::string(std::size_t{324} * 243, '0'));
  expect_refused(with("gap8"), "it has 324 x 243 pixels; the camera needs 324 columns and at least 244 rows");
  write_file(folder_ / "a.pgm", "P5\n# grey\n324 244\n255\n" + std::string(std::size_t{324} * 244 - 1, '0'));
  expect_refused(with("gap8"), "the file ends too early: it must have 79056 pixels");
  write_file(folder_ / "a.pgm", "P5\n324 244\n255\n" + std::string(std::size_t{324} * 244, '0'));
  expect_refused(with("ri5cy"), "board ri5cy has no device of kind gap8_udma");
}

TEST_F(BadInput, IsRefusedWithTheNameOfAnotherChip) {
  write_file(folder_ / "gap9.elf", read_file(program_) + "/sdk/pmsis_api/include/pmsis/chips/gap9");
  expect_refused(fmt::format("run {} --board gap8", folder_ / "gap9.elf"), "this program is for GAP9");
}

TEST_F(BadInput, IsRefusedIfFilesCannotBeReadOrWritten) {
  expect_refused("run /nowhere/x.elf", "/nowhere/x.elf: no such file");
  expect_refused("run /", "is not a regular file");
  expect_refused("run /dev/zero", "is not a regular file");
  expect_refused("run /dev/null", "is not a regular file");
  for (const auto* option : {"--trace", "--signature"}) {
    expect_refused(fmt::format("run {} {} /nowhere/out", program_, option), option);
  }
  expect_refused(fmt::format("run {} --profile /nowhere/out.json", program_), "--profile /nowhere/out.json: cannot be");
  expect_refused(fmt::format("run {} --trace /", program_), "--trace /: cannot be written");
  expect_refused(fmt::format("run {} --board /nowhere", program_), "/nowhere: cannot be read");
  expect_refused(fmt::format("run {} --board /", program_), "cannot be read");
}

TEST_F(BadInput, IsRefusedIfTwoOutputsHaveTheSameFile) {
  const auto before = read_file(program_);
  expect_refused(fmt::format("run {} --trace {}", program_, program_), "is also the program");
  EXPECT_EQ(read_file(program_), before);
  const auto file = folder_ / "both";
  expect_refused(fmt::format("run {} --trace {} --signature {}", program_, file, file), "both name");
}

TEST_F(BadInput, IsRefusedForUnknownKindsOfProfilesAndPowerTraces) {
  expect_refused(fmt::format("run {} --profile {}", program_, folder_ / "p.txt"), "must end in .json");
  expect_refused(fmt::format("run {} --power-trace {}", program_, folder_ / "p.txt"), "must end in .json");
  expect_refused(fmt::format("run {} --page {} --profile {}", program_, folder_ / "p.html", folder_ / "p.callgrind"),
                 "must end with .json, or be left out");
}

TEST_F(BadInput, IsRefusedForASignatureWithoutItsSymbols) {
  expect_refused(fmt::format("run {} --signature {}", program_, folder_ / "s"), "has no symbol begin_signature");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s"));
}

TEST_F(BadInput, IsRefusedWithTheReasonForAnotherMachine) {
  expect_refused(damaged(0, "ELF"), "not an ELF file");
  expect_refused(damaged(4, "\x02"), "64-bit");
  expect_refused(damaged(5, "\x02"), "big-endian");
  expect_refused(damaged(18, std::string("\x3e", 1)), "machine 62");
  expect_refused(damaged(16, "\x01"), "type 1");
  expect_refused(damaged(24, "\x01"), "entry point 0x80000001 is odd");
  expect_refused(damaged(27, "\x10"), "entry point 0x10000000 lies in none of its segments");
  write_file(folder_ / "empty.elf", "");
  expect_refused("run " + (folder_ / "empty.elf"), "cut short");
}

TEST_F(BadInput, IsRefusedIfTohostIsOutsideTheMemory) {
  const Folder folder;
  expect_refused("run " + folder.program("_start: nop\n1: j 1b\n.globl tohost\n.set tohost, 0x10000000"),
                 "tohost is at 0x10000000, where the board has no memory");
}

TEST_F(BadInput, IsRefusedIfTheProgramDoesNotFitTheBoard) {
  expect_refused(fmt::format("run {} --board '{}/configs/boards/ai_deck.json'", program_, MEBOTS_SOURCE_DIR),
                 "lies outside the board's memories");
}

// Programs of gap_sdk load .data_tiny_fc into the controller's memory, and address it by the memory's alias.
TEST_F(BadInput, IsNotASegmentThatRunsAtTheAliasOfAMemory) {
  constexpr std::uint32_t kMemory = 0x1b000000;
  auto elf = read_file(folder_.program(fmt::format("{}{}", kOk, kTohost), kMemory));
  const auto move = [&](std::size_t at, std::uint32_t by) {
    std::uint32_t address = 0;
    std::memcpy(&address, elf.data() + at, sizeof address);
    address += by;
    std::memcpy(elf.data() + at, &address, sizeof address);
  };
  constexpr std::size_t kHeaders = 52;
  constexpr std::size_t kHeaderBytes = 32;
  constexpr std::size_t kRunAddress = 8;  // p_vaddr in a program header
  const std::size_t count = static_cast<unsigned char>(elf[44]);
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = kHeaders + i * kHeaderBytes;
    if (elf[at] == 1) move(at + kRunAddress, -kMemory);
  }
  move(24, -kMemory);  // the entry point is a run address
  write_file(folder_ / "alias.elf", elf);
  const auto run = run_tool(fmt::format("run {} --board gap8", folder_ / "alias.elf"));
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;

  for (std::size_t i = 0; i < count; ++i)
    move(kHeaders + i * kHeaderBytes + kRunAddress, 0x10000 - 16);  // ends behind the alias
  move(24, 0x10000 - 16);
  write_file(folder_ / "alias.elf", elf);
  expect_refused(fmt::format("run {} --board gap8", folder_ / "alias.elf"), "lies outside the board's memories");
}

TEST_F(BadInput, IsRefusedIfTheCoreLacksTheProgramsFloatingPointRegisters) {
  constexpr std::size_t kFlags = 36;  // of the ELF header; 1: compressed instructions, 2: -mabi=ilp32f
  const auto program = damaged(kFlags, "\x03");
  expect_refused(program, "compiled for floating-point registers (-mabi=ilp32f)");
  EXPECT_EQ(run_tool(program + " --core rv32imfc").exit_code, 0);
}

TEST_F(BadInput, AStrippedProgramStillRuns) {
  std::string tool = MEBOTS_RISCV_STRIP;
  ASSERT_EQ(std::system((tool + " " + program_).c_str()), 0);
  const auto run = run_tool("run " + program_ + " --max-instructions 10");
  EXPECT_EQ(run.exit_code, 101) << "without tohost nothing ends it";
  EXPECT_THAT(run.err, HasSubstr("in no function of the program"));
}

}  // namespace
}  // namespace mebots::soc::test
