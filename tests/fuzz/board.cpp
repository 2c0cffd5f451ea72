// SPDX-License-Identifier: Apache-2.0
// Reads any text as a board file. The reader must throw Error, or return a board whose numbers are within their limits.
#include "board/board_file.hpp"

#include "mebots/error.hpp"

#include "require.hpp"

#include <cstdint>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using mebots::fuzz::require;
  try {
    const auto board = mebots::soc::parse_board({reinterpret_cast<const char*>(data), size}, "board.json");
    require(!board.memories.empty(), "a board has memory");
    for (const auto& memory : board.memories) require(memory.size >= 4, "a memory holds a word");
    for (const auto& device : board.devices) {
      require(device.base % 4 == 0, "a device's base is a word address");
      require(device.interrupt >= -1 && device.interrupt <= 31, "an interrupt is a bit of mip");
    }
  } catch (const mebots::Error&) {
  }
  return 0;
}
