// SPDX-License-Identifier: Apache-2.0
#include "elf/elf.hpp"
#include "board/board_file.hpp"

#include "assembler.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <initializer_list>
#include <random>
#include <span>
#include <utility>

namespace mebots::soc::test {
namespace {

using testing::HasSubstr;

const std::vector<std::uint8_t>& program() {
  static const auto bytes = assemble_file(
      "_start: nop\nadd_two: .type add_two, @function\naddi a0, a0, 2\nret\n.size add_two, . - add_two\n.data\n"
      "numbers: .word 1, 2\n.bss\nroom: .space 100\n");
  return bytes;
}

std::string error_of(const std::vector<std::uint8_t>& bytes) {
  try {
    Elf::parse(bytes, "fw.elf");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::vector<std::uint8_t> with_byte(std::size_t at, std::uint8_t value) {
  auto bytes = program();
  bytes[at] = value;
  return bytes;
}

TEST(Elf, RecognisesTheSdkOfAnotherChipByItsHeaders) {
  EXPECT_EQ(other_chip_of("\x7f"
                          "ELF /home/somebody/gap_sdk/rtos/pmsis/pmsis_api/include/pmsis/chips/gap9 x"),
            "GAP9");
  EXPECT_EQ(other_chip_of("/home/gap9/project/main.c chips/gap"), "") << "a folder of somebody's own";
}

TEST(Elf, GivesSegmentsEntryAndSymbols) {
  const auto elf = Elf::parse(program(), "fw.elf");
  EXPECT_EQ(elf.entry(), 0x80000000U);
  EXPECT_EQ(elf.segments().front().load_address, 0x80000000U);
  EXPECT_EQ(elf.symbol("_start"), 0x80000000U);
  EXPECT_EQ(elf.symbol("nowhere"), std::nullopt);
  const auto function = *elf.symbol("add_two");
  EXPECT_EQ(elf.where(function), "add_two");
  EXPECT_EQ(elf.where(function + 2), "add_two+0x2");
  EXPECT_EQ(elf.where(0x1000), "");
  std::uint64_t in_memory = 0;
  for (const auto& segment : elf.segments()) in_memory += segment.size;
  EXPECT_GE(in_memory, 100U + 8U) << "what the file does not give, too";
}

/// Assembles a function of four instructions on lines 7, 9, 9 and 12 of power.c. `version` is the version of DWARF.
std::vector<std::uint8_t> program_with_lines(int version) {
  return assemble_file(
      fmt::format(".section .text\n.file 1 \"app/power.c\"\n.option norvc\n_start: .type _start, @function\n"
                  ".loc 1 7\nnop\n.loc 1 9\nnop\nnop\n.loc 1 12\nret\n.size _start, . - _start\n"),
      0x80000000, fmt::format("-gdwarf-{}", version));
}

TEST(Elf, ReturnsTheLineOfTheSource) {
  for (const int version : {2, 3, 4, 5}) {
    const auto elf = Elf::parse(program_with_lines(version), "fw.elf");
    EXPECT_EQ(elf.where(0x80000000), "_start (power.c:7)") << version;
    EXPECT_EQ(elf.where(0x80000004), "_start+0x4 (power.c:9)") << version;
    EXPECT_EQ(elf.where(0x80000008), "_start+0x8 (power.c:9)") << version;
    EXPECT_EQ(elf.where(0x8000000c), "_start+0xc (power.c:12)") << version;
    EXPECT_EQ(elf.where_called(0x8000000c), "_start+0xc (power.c:9)") << "the call is before " << version;
    EXPECT_EQ(elf.where(0x80000010), "");
  }
}

TEST(Elf, HasNoLinesIfTheLineTableIsBroken) {
  const auto whole = program_with_lines(5);
  std::mt19937 random(7);
  int without = 0;
  for (int i = 0; i < 3000; ++i) {
    auto bytes = whole;
    // Changes bytes after the program headers and segments, where the sections are. The first sections contain the line
    // numbers.
    for (int k = 0; k < 4; ++k) bytes[0x80 + random() % (bytes.size() - 0x80)] = static_cast<std::uint8_t>(random());
    try {
      if (Elf::parse(bytes, "fw.elf").where(0x80000004).find("power.c:9") == std::string::npos) ++without;
    } catch (const Error&) {  // the reader may reject the file for any reason
    }
  }
  EXPECT_GT(without, 100) << "some of them hit the lines";
}

TEST(Elf, IsRefusedWithTheReasonIfItIsOfAnotherKind) {
  EXPECT_THAT(error_of(with_byte(0, 0)), HasSubstr("not an ELF file"));
  EXPECT_THAT(error_of(with_byte(4, 2)), HasSubstr("64-bit"));
  EXPECT_THAT(error_of(with_byte(5, 2)), HasSubstr("big-endian"));
  EXPECT_THAT(error_of(with_byte(18, 40)), HasSubstr("machine 40"));
  EXPECT_THAT(error_of(with_byte(16, 1)), HasSubstr("type 1"));
  EXPECT_THAT(error_of(with_byte(36, 5)), HasSubstr("floating-point"));
  EXPECT_THAT(error_of(with_byte(27, 0x90)), HasSubstr("entry point 0x90000000"));
  EXPECT_THAT(error_of({}), HasSubstr("cut short"));
}

TEST(Elf, NamesAMissingFile) {
  try {
    Elf::read("/nowhere/fw.elf");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nowhere/fw.elf: no such file"));
  }
  EXPECT_THROW(Elf::read("/"), Error);
}

TEST(Elf, TruncatedAtAnyLengthIsAnErrorOrWhole) {
  const auto& whole = program();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::vector<std::uint8_t> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_NE(error_of(cut), "no error") << length;  // the section headers are at the file's end
  }
}

TEST(Elf, IsRefusedIfSegmentsOverlap) {
  // Adds a copy of the first program header, because GNU ld writes only one segment for this program.
  auto bytes = program();
  std::uint32_t table = 0;
  std::uint16_t count = 0;
  std::memcpy(&table, &bytes[28], 4);
  std::memcpy(&count, &bytes[44], 2);
  std::size_t load = 0;
  while (bytes[table + 32 * load] != 1) ++load;
  const std::size_t other = load == 0 ? 1 : 0;
  ASSERT_LT(other, count);
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(table + 32 * load), 32,
              bytes.begin() + static_cast<std::ptrdiff_t>(table + 32 * other));
  EXPECT_THAT(error_of(bytes), HasSubstr("overlap"));
}

TEST(Elf, DoesNotCrashTheReaderWithDamagedBytes) {
  std::mt19937 random(3);  // NOLINT: the same damage each time
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    auto bytes = program();
    for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (error_of(bytes) != "no error") ++refused;
  }
  EXPECT_GT(refused, 100);
}

/// Returns an ELF file with two program headers, each for 16 bytes of the file: code at 0x1000, and data with these
/// addresses and sizes.
std::vector<std::uint8_t> with_data_segment(std::uint32_t run, std::uint32_t load, std::uint32_t file_size,
                                            std::uint32_t memory_size, std::uint32_t entry = 0x1000) {
  std::vector<std::uint8_t> bytes(52 + 2 * 32 + 32);
  const auto put = [&](std::size_t at, std::uint32_t value, std::size_t size) {
    std::memcpy(&bytes[at], &value, size);
  };
  const std::array<std::uint8_t, 7> ident{0x7f, 'E', 'L', 'F', 1, 1, 1};
  std::ranges::copy(ident, bytes.begin());
  put(16, 2, 2);  // executable file
  put(18, 243, 2);
  put(24, entry, 4);
  put(28, 52, 4);
  put(42, 32, 2);
  put(44, 2, 2);
  const auto segment = [&](std::size_t at, std::initializer_list<std::uint32_t> words) {
    for (const auto word : words) put(std::exchange(at, at + 4), word, 4);
  };
  segment(52, {1, 116, 0x1000, 0x1000, 16, 16, 5, 4});
  segment(84, {1, 132, run, load, file_size, memory_size, 6, 4});
  return bytes;
}

TEST(Elf, SupportsLoadAndRunAddresses) {
  const auto elf = Elf::parse(with_data_segment(0x20000, 0x1010, 16, 64), "fw.elf");
  ASSERT_EQ(elf.segments().size(), 2U);
  EXPECT_EQ(elf.segments()[1].load_address, 0x1010U);
  EXPECT_EQ(elf.segments()[1].run_address, 0x20000U);
  EXPECT_EQ(elf.segments()[1].bytes.size(), 16U);
  EXPECT_EQ(elf.segments()[1].size, 64U);
  EXPECT_THAT(error_of(with_data_segment(0x20000, 0x100f, 16, 64)), HasSubstr("overlap at their load addresses"));
}

TEST(Elf, AllowsOverlapWithASectionWithoutBytes) {
  EXPECT_EQ(error_of(with_data_segment(0x20000, 0x1008, 0, 4096)), "no error") << "NOLOAD after data with AT>";
  EXPECT_EQ(error_of(with_data_segment(0x20000, 0xfffffff0, 0, 4096)), "no error");
  EXPECT_THAT(error_of(with_data_segment(0xfffffff0, 0x1010, 0, 4096)), HasSubstr("run address 0xfffffff0 passes"));
}

TEST(Elf, StartsWhereItsFirstInstructionIsLoaded) {
  EXPECT_EQ(Elf::parse(with_data_segment(0x20000, 0x1010, 16, 16, 0x20004), "fw.elf").entry(), 0x1014U);
  EXPECT_THAT(error_of(with_data_segment(0x20000, 0x1010, 16, 64, 0x20010)), HasSubstr("lies in none of its segments"));
}

TEST(Elf, NamesTheExtensionsThatItWasCompiledFor) {
  EXPECT_THAT(Elf::parse(program(), "fw.elf").architecture(), testing::StartsWith("rv32i2p"));
  EXPECT_EQ(Elf::parse(with_data_segment(0x20000, 0x1010, 16, 64), "fw.elf").architecture(), "");
  const std::vector<std::uint8_t> whole{'A', 26, 0, 0, 0,  'r', 'i', 's', 'c', 'v', 0,   1, 15,
                                        0,   0,  0, 4, 16, 5,   'r', 'v', '3', '2', 'i', 0};
  EXPECT_EQ(architecture_in(whole), "rv32i");
  for (std::size_t size = 0; size + 6 < whole.size(); ++size)
    EXPECT_EQ(architecture_in(std::span(whole).first(size)), "");
}

}  // namespace
}  // namespace mebots::soc::test
