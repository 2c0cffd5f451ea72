// SPDX-License-Identifier: Apache-2.0
// Runs random programs on the simulated hart and on QEMU's RISC-V virt machine, whose RAM is a file. The programs log
// all registers every few instructions, and each trap. The logs and the data in RAM must be equal on both.
// MEBOTS_LOCKSTEP_INSTRUCTIONS is the number of random instructions (scripts/lockstep.sh).
#include "program.hpp"

#include "runs/hart.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <unistd.h>

namespace mebots::soc::test {
namespace {

std::uint64_t wanted_instructions() {
  const auto* text = std::getenv("MEBOTS_LOCKSTEP_INSTRUCTIONS");
  return text == nullptr ? 200'000 : std::strtoull(text, nullptr, 10);
}

/// A hart with 16 MiB of RAM, and a word that ends the run.
class Platform : public Bus {
 public:
  explicit Platform(std::span<const std::uint8_t> ram)
      : memory_(make_memory()), code_(memory_, {.timing = {CoreKind::rv32imc}}), hart_(memory_, *this, code_) {
    memory_.write(Layout::kCode, ram);
    memory_.mark(Layout::kTohost, 4, Region::kWatch);
    hart_.reset(Layout::kCode);
  }
  Hart& hart() { return hart_; }
  const std::uint8_t* ram() const { return memory_.regions()[0].data.get(); }

 private:
  static Memory make_memory() {
    Memory memory;
    memory.add("ram", Layout::kCode, Layout::kRamBytes);
    return memory;
  }
  BusReply load(std::uint32_t, std::uint64_t) override { return {}; }
  BusReply store(std::uint32_t, std::uint64_t, std::uint32_t) override { return {}; }
  bool watched(std::uint32_t) override { return true; }

  Memory memory_;
  DecodedCode code_;
  Hart hart_;
};

std::vector<std::uint8_t> image_of(const LockstepProgram& program) {
  std::vector<std::uint8_t> ram(Layout::kRamBytes);
  const auto put = [&](std::uint32_t address, const std::vector<std::uint8_t>& bytes) {
    std::memcpy(ram.data() + (address - Layout::kCode), bytes.data(), bytes.size());
  };
  put(Layout::kCode, program.code);
  put(Layout::kData, program.data);
  put(Layout::kStarts, program.starts);
  return ram;
}

/// Runs the RAM's content in QEMU, and returns the RAM afterwards. Execution starts at the RAM's first word and ends
/// with the machine's test device.
std::vector<std::uint8_t> run_on_qemu(const std::vector<std::uint8_t>& ram, const std::filesystem::path& path) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(ram.data()), static_cast<std::streamsize>(ram.size()));
  const auto command = fmt::format(
      "timeout 120 qemu-system-riscv32 -M virt,memory-backend=ram -m 16M "
      "-object memory-backend-file,id=ram,size=16M,mem-path={},share=on "
      "-cpu rv32,i=on,m=on,c=on,a=off,f=off,d=off,s=off,u=off,mmu=off,pmp=off,h=off "
      "-bios none -display none -serial none -monitor none -no-reboot",
      path.string());
  if (std::system(command.c_str()) != 0) return {};
  std::vector<std::uint8_t> after(ram.size());
  std::ifstream(path, std::ios::binary)
      .read(reinterpret_cast<char*>(after.data()), static_cast<std::streamsize>(after.size()));
  return after;
}

std::uint32_t word_at(const std::uint8_t* bytes) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Returns the record, the word and both values of the first difference between the logs; "none" if they are equal.
std::string first_difference(const std::uint8_t* ours, const std::uint8_t* theirs, std::uint32_t bytes) {
  for (std::uint32_t at = 0; at < bytes; at += 4) {
    if (word_at(ours + at) == word_at(theirs + at)) continue;
    return fmt::format("record {} word {}: 0x{:08x} here, 0x{:08x} on QEMU", at / Layout::kRecordBytes,
                       at % Layout::kRecordBytes / 4, word_at(ours + at), word_at(theirs + at));
  }
  return "none";
}

TEST(Lockstep, RandomProgramsDoTheSameOnQemu) {
  if (std::system("qemu-system-riscv32 --version > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "qemu-system-riscv32 is not installed: scripts/setup.sh bench, or Debian's qemu-system-misc";
  }
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("mebots-lockstep-{}", getpid());
  std::filesystem::create_directories(folder);
  constexpr std::uint32_t kTurns = 60;
  constexpr std::uint64_t kNotingInstructions = 37;  // number of instructions that write a record; a trap needs fewer
  const auto wanted = wanted_instructions();
  std::uint64_t compared = 0;
  std::uint64_t executed = 0;
  std::uint64_t records = 0;
  std::uint64_t programs = 0;
  for (std::uint64_t seed = 1; compared < wanted; ++seed) {
    const auto program = make_lockstep_program(seed, 4000, kTurns);
    const auto before = image_of(program);
    Platform platform(before);
    ASSERT_EQ(platform.hart().run(2'000'000'000), Stop::watch)
        << fmt::format("seed {}: pc 0x{:08x}", seed, platform.hart().pc());
    const auto after = run_on_qemu(before, folder / "ram");
    ASSERT_FALSE(after.empty()) << "QEMU failed or did not end";
    const auto* ours = platform.ram();
    const auto* theirs = after.data();
    const auto log = Layout::kLog - Layout::kCode;
    const auto log_bytes = Layout::kLogEnd - Layout::kLog;
    const auto data = Layout::kData - Layout::kCode;
    ASSERT_EQ(std::memcmp(ours + log, theirs + log, log_bytes), 0)
        << "seed " << seed << ", " << first_difference(ours + log, theirs + log, log_bytes);
    ASSERT_EQ(std::memcmp(ours + data, theirs + data, Layout::kDataBytes), 0) << "seed " << seed;
    ASSERT_EQ(word_at(theirs + (Layout::kControl - Layout::kCode)), kTurns + 1) << "QEMU ran all turns";
    std::uint32_t used = log_bytes;
    while (used > 0 && word_at(ours + log + used - 4) == 0 &&
           word_at(ours + log + used - Layout::kRecordBytes + 8) == 0) {
      used -= Layout::kRecordBytes;
    }
    ASSERT_LT(used, log_bytes) << "the log is full";
    records += used / Layout::kRecordBytes;
    executed += platform.hart().counters().instructions;
    compared = executed - records * kNotingInstructions;
    ++programs;
  }
  std::filesystem::remove_all(folder);
  fmt::print(
      "{} programs, at least {} random instructions ({} executed with those that note), {} times all registers or a "
      "trap compared\n",
      programs, compared, executed, records);
}

}  // namespace
}  // namespace mebots::soc::test
