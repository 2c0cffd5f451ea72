// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

/// Reads the study files of `mebots sweep`.
namespace mebots::master::study {

/// Reads and checks a study file without opening its mission and FMUs. Throws data::Mistakes with all mistakes.
nlohmann::ordered_json read(const std::filesystem::path& file);
/// Reads and checks the text of a study. Messages contain `file`.
nlohmann::ordered_json read(const std::string& text, const std::filesystem::path& file);

}  // namespace mebots::master::study
