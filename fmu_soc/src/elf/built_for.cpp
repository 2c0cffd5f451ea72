// SPDX-License-Identifier: Apache-2.0
#include "elf/built_for.hpp"

#include "board_file.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace mebots::soc {
namespace {

/// A number of an attribute: seven bits a byte, the lowest first. Null at the end of the bytes.
std::optional<std::uint32_t> take_number(std::span<const std::uint8_t>& bytes) {
  std::uint32_t value = 0;
  for (unsigned shift = 0; !bytes.empty() && shift < 32; shift += 7) {
    const auto byte = bytes.front();
    bytes = bytes.subspan(1);
    value |= (byte & 0x7fU) << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

std::string take_text(std::span<const std::uint8_t>& bytes) {
  const auto end = std::ranges::find(bytes, std::uint8_t{0});
  const std::string text(bytes.begin(), end);
  bytes = bytes.subspan(std::min(bytes.size(), text.size() + 1));
  return text;
}

}  // namespace

std::string architecture_in(std::span<const std::uint8_t> attributes) {
  constexpr std::uint8_t kVersion = 'A';
  constexpr std::size_t kLength = 4;
  constexpr std::uint32_t kWholeFile = 1;
  constexpr std::uint32_t kArchitecture = 5;
  auto bytes = attributes;
  if (bytes.size() < 1 + kLength || bytes.front() != kVersion) return {};
  bytes = bytes.subspan(1 + kLength);
  if (take_text(bytes) != "riscv" || take_number(bytes) != kWholeFile || bytes.size() < kLength) return {};
  bytes = bytes.subspan(kLength);
  while (const auto tag = take_number(bytes)) {
    const bool is_text = *tag % 2 == 1;
    if (is_text) {
      auto text = take_text(bytes);
      if (*tag == kArchitecture) return text;
    } else if (!take_number(bytes)) {
      break;
    }
  }
  return {};
}

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
