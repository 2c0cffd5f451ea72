// SPDX-License-Identifier: Apache-2.0
#include "elf/built_for.hpp"

#include "board_file.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>

namespace mebots::soc {

std::string_view other_chip_of(std::string_view elf_bytes) {
  // Folders of the SDKs' headers; long enough that nobody has them by chance.
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kFolders{{
      {"pmsis/chips/gap9", "GAP9"},
      {"vendors/gwt/gap9", "GAP9"},
      {"install/GAP9/include", "GAP9"},
      {"archi/chips/wolfe", "Mr. Wolf"},
  }};
  for (const auto& [folder, chip] : kFolders) {
    if (elf_bytes.find(folder) != std::string_view::npos) return chip;
  }
  return {};
}

void require_own_chip(const std::filesystem::path& program, const BoardDescription& board) {
  if (std::ranges::find(board.devices, "gap8_event_unit", &BoardDevice::kind) == board.devices.end()) return;
  std::error_code error;
  std::ifstream file(program, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(program, error)) return;
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  if (const auto chip = other_chip_of(bytes); !chip.empty()) {
    throw Error(fmt::format("{}: this program is for {}; board {} is a GAP8: take the program that was built for it",
                            program.string(), chip, board.name));
  }
}

}  // namespace mebots::soc
