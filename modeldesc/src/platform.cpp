// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/platform.hpp"

#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"

#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;
using enum BinaryFormat;

// Processor types in the headers. Sources: Microsoft, "PE Format", section Machine Types; <mach/machine.h> of macOS.
constexpr std::uint32_t kPeI386 = 0x14c;
constexpr std::uint32_t kPeAmd64 = 0x8664;
constexpr std::uint32_t kPeArm64 = 0xaa64;
constexpr std::uint32_t kMach64Bit = 0x0100'0000;
constexpr std::uint32_t kMachX86 = 7;
constexpr std::uint32_t kMachX86_64 = kMach64Bit | kMachX86;
constexpr std::uint32_t kMachArm64 = kMach64Bit | 12;

// FMI 2.0 defines names for six platforms and permits other names. In this table, the other platforms have the names of
// FMI 3.0 for both versions.
constexpr Platform kPlatforms[] = {
    {elf, 64, EM_X86_64, "linux64", "x86_64-linux", ".so", "x86-64 Linux"},
    {elf, 32, EM_386, "linux32", "x86-linux", ".so", "32-bit x86 Linux"},
    {elf, 64, EM_AARCH64, "aarch64-linux", "aarch64-linux", ".so", "64-bit ARM Linux"},
    {elf, 32, EM_ARM, "aarch32-linux", "aarch32-linux", ".so", "32-bit ARM Linux"},
    {elf, 64, EM_RISCV, "riscv64-linux", "riscv64-linux", ".so", "64-bit RISC-V Linux"},
    {elf, 32, EM_RISCV, "riscv32-linux", "riscv32-linux", ".so", "32-bit RISC-V Linux"},
    {pe, 64, kPeAmd64, "win64", "x86_64-windows", ".dll", "x86-64 Windows"},
    {pe, 32, kPeI386, "win32", "x86-windows", ".dll", "32-bit x86 Windows"},
    {pe, 64, kPeArm64, "aarch64-windows", "aarch64-windows", ".dll", "64-bit ARM Windows"},
    {mach_o, 64, kMachX86_64, "darwin64", "x86_64-darwin", ".dylib", "x86-64 macOS"},
    {mach_o, 32, kMachX86, "darwin32", "x86-darwin", ".dylib", "32-bit x86 macOS"},
    {mach_o, 64, kMachArm64, "aarch64-darwin", "aarch64-darwin", ".dylib", "64-bit ARM macOS"},
};

template <typename T>
T at(std::string_view bytes, std::size_t offset) {
  T value{};
  if (offset + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

const Platform* find(BinaryFormat format, int bits, std::uint32_t machine) {
  const auto* const found = std::ranges::find_if(kPlatforms, [&](const Platform& platform) {
    return platform.format == format && platform.bits == bits && platform.machine == machine;
  });
  return found == std::end(kPlatforms) ? nullptr : found;
}

const Platform* find_mach_o(std::uint32_t machine) {
  return find(mach_o, (machine & kMach64Bit) != 0 ? 64 : 32, machine);
}

std::uint32_t big_endian(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8U | at<std::uint8_t>(bytes, offset + i);
  return value;
}

/// Returns the platforms of a universal library of macOS. The header has one row per platform (<mach-o/fat.h>). `start`
/// contains the first bytes of the file.
std::vector<const Platform*> platforms_of_universal(std::string_view start) {
  constexpr std::size_t kHeader = 8;
  constexpr std::size_t kRow = 20;
  std::vector<const Platform*> found;
  const auto rows = big_endian(start, 4);
  for (std::size_t i = 0; i < rows && kHeader + (i + 1) * kRow <= start.size(); ++i) {
    if (const auto* const platform = find_mach_o(big_endian(start, kHeader + i * kRow))) found.push_back(platform);
  }
  return found;
}

/// Returns the platform of a library for one platform; null if the platform is unknown. `start` contains the first
/// bytes of the file.
const Platform* platform_in(std::string_view start) {
  using namespace std::string_view_literals;
  if (start.starts_with("\x7f"
                        "ELF")) {
    const auto bits = at<std::uint8_t>(start, EI_CLASS) == ELFCLASS64 ? 64 : 32;
    return find(elf, bits, at<std::uint16_t>(start, offsetof(Elf64_Ehdr, e_machine)));
  }
  if (start.starts_with("MZ")) {
    constexpr std::size_t kPlaceOfHeader = 0x3c;
    const std::size_t header = at<std::uint32_t>(start, kPlaceOfHeader);
    if (header >= start.size() || !start.substr(header).starts_with("PE\0\0"sv)) return nullptr;
    const auto machine = at<std::uint16_t>(start, header + 4);
    return find(pe, machine == kPeI386 ? 32 : 64, machine);
  }
  constexpr std::uint32_t kMach32 = 0xfeed'face;
  constexpr std::uint32_t kMach64 = 0xfeed'facf;
  const auto magic = at<std::uint32_t>(start, 0);
  return magic == kMach32 || magic == kMach64 ? find_mach_o(at<std::uint32_t>(start, 4)) : nullptr;
}

}  // namespace

std::span<const Platform> platforms() {
  return kPlatforms;
}

const Platform& this_platform() {
#if defined(__aarch64__)
  constexpr std::uint32_t kMachine = EM_AARCH64;
#elif defined(__riscv)
  constexpr std::uint32_t kMachine = EM_RISCV;
#else
  constexpr std::uint32_t kMachine = EM_X86_64;
#endif
  return *find(elf, 64, kMachine);
}

std::vector<const Platform*> find_platforms(const fs::path& library) {
  constexpr std::uint32_t kUniversal = 0xcafe'babe;
  std::array<char, 4096> start;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled by read()
  std::ifstream stream(library, std::ios::binary);
  if (!stream) throw Error(ErrorCode::file_unreadable, fmt::format("{}: cannot be opened", library.string()));
  stream.read(start.data(), std::ssize(start));
  const std::string_view read(start.data(), static_cast<std::size_t>(stream.gcount()));
  if (big_endian(read, 0) == kUniversal) return platforms_of_universal(read);
  const auto* const platform = platform_in(read);
  return platform == nullptr ? std::vector<const Platform*>{} : std::vector{platform};
}

bool is_built_for(const Platform& platform, const fs::path& library) {
  const auto found = find_platforms(library);
  return std::ranges::find(found, &platform) != found.end();
}

const Platform& platform_of(const fs::path& library) {
  if (const auto found = find_platforms(library); !found.empty()) return *found.front();
  throw Error(ErrorCode::fmu_inconsistent,
              fmt::format("{}: is not a shared library of a platform that FMI names; it must be one of Linux (ELF), "
                          "Windows (DLL) or macOS",
                          library.string()));
}

fs::path binaries_folder(const fs::path& fmu, bool is_fmi3, std::string_view file) {
  const auto& own = this_platform();
  auto folder = fmu / "binaries" / own.folder(is_fmi3);
  if (is_fmi3 || is_there(folder)) return folder;
  auto usual = fmu / "binaries" / "linux64";
  if (is_file(usual / file) && is_built_for(own, usual / file)) return usual;
  return folder;
}

}  // namespace mebots::modeldesc
