// SPDX-License-Identifier: Apache-2.0
#include "elf/built_for.hpp"

#include <array>
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

}  // namespace mebots::soc
