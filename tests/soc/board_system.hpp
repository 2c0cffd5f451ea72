// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "assembler.hpp"
#include "devices/generic/camera.hpp"
#include "soc/soc.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::test {

inline constexpr std::uint32_t kL2 = 0x1C000000;
inline constexpr std::int64_t kMs = 1'000'000;
/// Address at which test programs store their results. Three quarters of L2 are below it.
inline constexpr std::uint32_t kResults = 0x1C060000;

/// Simulates a board, by default the AI-deck, with an assembler program. The program can use the names of board.h.
class BoardSystem {
 public:
  explicit BoardSystem(std::string_view text, const Settings& settings = {}, const BoardDescription& board = ai_deck())
      : BoardSystem(assembled(text), settings, board) {}
  explicit BoardSystem(const Elf& program, const Settings& settings = {}, const BoardDescription& board = ai_deck())
      : soc(board, gap8(), settings, program,
            {[this](std::string_view line) { console.emplace_back(line); },
             [this](std::string_view text) { faults.emplace_back(text); },
             {}}) {}

  static BoardDescription ai_deck() { return read_board(MEBOTS_SOURCE_DIR "/configs/boards/ai_deck.json"); }
  /// For tests that count every cycle of code that runs once.
  static BoardDescription without_caches() {
    auto board = ai_deck();
    board.instruction_caches = {};
    return board;
  }
  /// Returns the AI-deck with a camera whose pictures are narrow and may have any number of rows.
  static BoardDescription narrow(double frame_width = 64) {
    auto board = ai_deck();
    for (auto& device : board.devices) {
      for (auto& variable : device.variables) {
        if (variable.name == "camera.frame_width") variable.start = frame_width;
        if (variable.name == "camera.frame_height") variable.start = 0;
      }
    }
    return board;
  }
  static Elf assembled(std::string_view text) { return assemble(fmt::format("#include \"board.h\"\n{}\n", text), kL2); }

  Camera& camera() { return dynamic_cast<Camera&>(*soc.devices().find("camera")); }
  double camera_energy_j() const { return soc.power().energy_j(*soc.devices().find("camera")); }
  double output(std::string_view variable) const { return *soc.devices().output(variable); }

  std::uint32_t result(std::uint32_t index) const {
    std::uint32_t value = 0;
    soc.memory().read(kResults + 4 * index, {reinterpret_cast<std::uint8_t*>(&value), sizeof value});
    return value;
  }

  std::vector<std::string> console;
  std::vector<std::string> faults;
  Soc soc;
};

}  // namespace mebots::soc::test
