// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/texture.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace mebots::world::scene {

/// The grey levels of a PNG picture: colours by their luminance, what is transparent on black. Throws mebots::Error
/// that begins with `name` when it is not a PNG, is damaged, or is larger than 4096 x 4096.
Picture decode_png(std::span<const std::uint8_t> bytes, const std::string& name);
Picture read_png(const std::filesystem::path& file);

}  // namespace mebots::world::scene
