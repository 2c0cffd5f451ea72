// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>

namespace mebots::master::flight {

/// Reads an airframe: the files of a drone, of its rotors and of its cell, with mass and decks. Returns its content
/// with the paths of these files absolute; names of shipped files stay names. Throws data::Mistakes with all mistakes
/// of the file.
nlohmann::ordered_json read_airframe(const std::filesystem::path& file);

}  // namespace mebots::master::flight
