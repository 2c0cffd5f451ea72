// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

/// Reader of study files. `mebots sweep` runs the missions of a study (master/python/mebots/exploration).
namespace mebots::master::study {

/// Reads and checks a study file, without opening its mission or any FMU. Throws data::Mistakes with all errors.
nlohmann::ordered_json read(const std::filesystem::path& file);
/// Reads and checks the text of a study. `file` is its name in messages.
nlohmann::ordered_json read(const std::string& text, const std::filesystem::path& file);

}  // namespace mebots::master::study
