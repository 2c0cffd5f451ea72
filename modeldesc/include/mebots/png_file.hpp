// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace mebots {

/// The grey levels of a picture, row by row from the top left.
struct GreyPicture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> grey;

  bool operator==(const GreyPicture&) const = default;
};

/// Decodes a PNG picture. Converts colours to their luminance, and draws transparent pixels on black. Throws an Error
/// that begins with `name` if the bytes are not a PNG file, if the file is damaged, or if the picture is larger than
/// 4096 x 4096.
GreyPicture decode_png(std::span<const std::uint8_t> bytes, const std::string& name);
GreyPicture read_png(const std::filesystem::path& file);

}  // namespace mebots
