// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

/// Generates random RV32IMC_Zicsr programs. They store all registers every few instructions, and each trap, in a log in
/// RAM.
namespace mebots::soc::test {

struct Layout {
  static constexpr std::uint32_t kCode = 0x80000000;
  static constexpr std::uint32_t kData = 0x80200000;  // target of loads and stores
  static constexpr std::uint32_t kDataBytes = 0x10000;
  static constexpr std::uint32_t kStarts = 0x80300000;   // registers at the start of each iteration
  static constexpr std::uint32_t kControl = 0x803ff000;  // number of completed iterations; tohost
  static constexpr std::uint32_t kTohost = kControl + 64;
  static constexpr std::uint32_t kLog = 0x80400000;
  static constexpr std::uint32_t kLogEnd = 0x80d00000;
  static constexpr std::uint32_t kRamBytes = 0x1000000;
  static constexpr std::uint32_t kRecordBytes = 128;  // of the log: x1 to x31; or of a trap: cause, value, status, pc
};

struct LockstepProgram {
  std::vector<std::uint8_t> code;    // placed at Layout::kCode, which is the entry
  std::vector<std::uint8_t> data;    // placed at Layout::kData
  std::vector<std::uint8_t> starts;  // placed at Layout::kStarts
};

/// Returns a program of about `length` random instructions. The program runs them `turns` times with different
/// registers.
LockstepProgram make_lockstep_program(std::uint64_t seed, std::size_t length, std::uint32_t turns);

}  // namespace mebots::soc::test
