// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mebots::test {

/// Returns the bytes of a DLL for x86-64 Windows without code. It imports from `needed` and exports `names`. It has one
/// section, whose addresses are offsets in the file plus 0x1000.
inline std::string windows_dll(const std::vector<std::string>& needed, const std::vector<std::string>& names) {
  constexpr std::uint32_t kHeader = 0x40;
  constexpr std::uint32_t kOptional = kHeader + 24;
  constexpr std::uint32_t kDirectories = kOptional + 112;
  constexpr std::uint32_t kSections = kDirectories + 16 * 8;
  constexpr std::uint32_t kContent = 0x200;
  constexpr std::uint32_t kShift = 0x1000;
  std::string bytes(kContent, '\0');
  const auto put = [&](std::size_t offset, std::uint64_t value, std::size_t size) {
    if (bytes.size() < offset + size) bytes.resize(offset + size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[offset + i] = static_cast<char>(value >> 8 * i);
  };
  const auto text = [&](const std::string& value) {
    const auto address = static_cast<std::uint32_t>(bytes.size()) + kShift;
    bytes += value + '\0';
    return address;
  };
  bytes.replace(0, 2, "MZ");
  put(0x3c, kHeader, 4);
  bytes.replace(kHeader, 2, "PE");
  put(kHeader + 4, 0x8664, 2);                  // machine
  put(kHeader + 6, 1, 2);                       // sections
  put(kHeader + 20, kSections - kOptional, 2);  // size of the optional header
  put(kHeader + 22, 0x2000, 2);                 // a DLL
  put(kOptional, 0x20b, 2);                     // PE32+
  put(kOptional + 108, 16, 4);                  // directories
  const auto imports = bytes.size();
  bytes.resize(imports + 20 * (needed.size() + 1), '\0');
  for (std::size_t i = 0; i < needed.size(); ++i) put(imports + 20 * i + 12, text(needed[i]), 4);
  const auto exports = bytes.size();
  bytes.resize(exports + 40 + 4 * names.size(), '\0');
  put(exports + 24, names.size(), 4);
  put(exports + 32, exports + 40 + kShift, 4);
  for (std::size_t i = 0; i < names.size(); ++i) put(exports + 40 + 4 * i, text(names[i]), 4);
  put(kDirectories, exports + kShift, 4);
  put(kDirectories + 8, imports + kShift, 4);
  put(kSections + 12, kContent + kShift, 4);
  put(kSections + 16, bytes.size() - kContent, 4);
  put(kSections + 20, kContent, 4);
  return bytes;
}

}  // namespace mebots::test
