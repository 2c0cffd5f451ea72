// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

/// Reads study files. `mebots sweep` runs the missions of a study (master/python/mebots/exploration).
namespace mebots::master::study {

/// Reads and checks a study file, but opens neither its mission nor any FMU. Throws data::Mistakes with all mistakes.
nlohmann::ordered_json read(const std::filesystem::path& file);
/// Reads and checks the text of a study. `file` is the name of the text in messages.
nlohmann::ordered_json read(const std::string& text, const std::filesystem::path& file);

}  // namespace mebots::master::study
