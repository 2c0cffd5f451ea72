// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace mebots::modeldesc {

enum class BinaryFormat { elf, pe, mach_o };

/// A combination of operating system and processor, with the names that FMI defines for it.
struct Platform {
  BinaryFormat format = BinaryFormat::elf;
  int bits = 64;
  std::uint32_t machine = 0;     ///< value in the header of the format: EM_X86_64, IMAGE_FILE_MACHINE_AMD64 and so on
  std::string_view fmi2_folder;  ///< folder in binaries/ in FMI 1.0 and 2.0
  std::string_view fmi3_folder;  ///< folder in binaries/ in FMI 3.0: <architecture>-<system>
  std::string_view suffix;       ///< suffix of a library's file name, with the dot
  std::string_view text;         ///< name in messages, such as "x86-64 Linux"

  std::string_view folder(bool is_fmi3) const { return is_fmi3 ? fmi3_folder : fmi2_folder; }
  bool operator==(const Platform& other) const { return fmi3_folder == other.fmi3_folder; }
};

std::span<const Platform> platforms();

/// Returns the platform that this program was built for.
const Platform& this_platform();

/// Returns the platforms of a shared library, according to the file's header. A universal library of macOS can have
/// several platforms. Returns an empty list if the file is not a library for a known platform. Throws mebots::Error if
/// the file cannot be read.
std::vector<const Platform*> find_platforms(const std::filesystem::path& library);

bool is_built_for(const Platform& platform, const std::filesystem::path& library);

/// Returns the first platform of a shared library. Throws mebots::Error if the library has no known platform.
const Platform& platform_of(const std::filesystem::path& library);

/// Returns the folder with the libraries for this machine in an unpacked FMU: `binaries/` and the platform's name. FMI
/// 2.0 has no name for Linux on processors other than x86, so some tools use `linux64` for all processors. Therefore,
/// if an FMU of FMI 1.0 or 2.0 lacks this folder, and `binaries/linux64` contains a library `file` for this machine,
/// returns `binaries/linux64`.
std::filesystem::path binaries_folder(const std::filesystem::path& fmu, bool is_fmi3, std::string_view file);

}  // namespace mebots::modeldesc
