// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board_system.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace mebots::soc::test {

/// Simulates GAP8 with a program of assembly text. The program can use the registers of the firmware's headers, and
/// RESULTS, which is kResults.
class Gap8System : public BoardSystem {
 public:
  explicit Gap8System(std::string_view text, const Settings& settings = {}, const BoardDescription& board = gap8())
      : BoardSystem(assembled(text), settings, board) {}
  explicit Gap8System(const Elf& program, const Settings& settings = {}, const BoardDescription& board = gap8())
      : BoardSystem(program, settings, board) {}

  static BoardDescription gap8() { return read_board(MEBOTS_SOURCE_DIR "/configs/boards/gap8.json"); }
  static Elf assembled(std::string_view text) {
    const auto program = fmt::format("#include \"runtime/registers.h\"\n#define RESULTS 0x{:x}\n{}\n", kResults, text);
    return Elf::parse(assemble_file(program, kL2, MEBOTS_GAP8_INCLUDES), "test program");
  }
};

/// Interrupt vectors and start code. The fabric controller continues after this code. The cluster's cores jump to
/// `core`, and exceptions to `fault`.
inline constexpr std::string_view kBegin = R"(
    .balign 256
vectors: j fault
    .org vectors + 0x80
    .globl _start
_start: csrr a0, mhartid
    li a1, 0x400
    bne a0, a1, core
)";

/// Returns code that starts the cluster's cores whose bits are set in `who`.
inline std::string start_cluster(std::uint32_t who) {
  return fmt::format(R"(
    li s0, SOC_CONTROL_BASE
    li a0, BYPASS_CLUSTER_ON
    sw a0, SOC_CONTROL_CL_BYPASS_OFFSET(s0)
    li s0, CLUSTER_BASE
    la a1, vectors
    li a2, 8
    addi a3, s0, CLUSTER_BOOT_OFFSET
1:  sw a1, 0(a3)
    addi a3, a3, 4
    addi a2, a2, -1
    bnez a2, 1b
    li a0, {}
    sw a0, CLUSTER_FETCH_ENABLE_OFFSET(s0)
)",
                     who);
}

/// Returns code that sets the cluster's clock to a multiple of the reference clock.
inline std::string set_cluster_clock(std::uint32_t factor) {
  return fmt::format("li s0, FLL_BASE\n li a0, 1 << 26 | {}\n sw a0, FLL_BYTES + FLL_CONFIG1_OFFSET(s0)", factor);
}

/// Returns a system that runs a program on the cores whose bits are set in `cores`. All exceptions and interrupts of
/// the program go to `fault`.
inline Gap8System timed_system(unsigned cores, std::string_view code, const Settings& settings = {}) {
  auto board = Gap8System::gap8();
  board.instruction_caches = {};  // a refill would delay the read after the event
  const auto vectors = std::string(kBegin).replace(kBegin.find("j fault"), 7, ".rept 32\n j fault\n .endr");
  return Gap8System(fmt::format("{}{}{}", vectors, start_cluster(cores), code), settings, board);
}

}  // namespace mebots::soc::test
