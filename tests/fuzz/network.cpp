// SPDX-License-Identifier: Apache-2.0
// Reads any text as the network.json of a deployed network. The reader must throw Error, or return a network with a
// program in its folder.
#include "board/network_folder.hpp"
#include "folder_of_input.hpp"
#include "mebots/error.hpp"
#include "require.hpp"

#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static mebots::fuzz::FolderOfInput folder;
  mebots::soc::BoardDescription board;
  board.name = "ai_deck";
  folder.fill({reinterpret_cast<const char*>(data), size}, "network.json");
  try {
    const auto program = mebots::soc::program_with_network(folder.path(), "sight", board);
    mebots::fuzz::require(program.parent_path() == folder.path() && program.has_filename(),
                          "the program is a file in the folder");
  } catch (const mebots::Error&) {
  }
  folder.clear();
  return 0;
}
