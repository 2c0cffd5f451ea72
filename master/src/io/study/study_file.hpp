// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

/// A study asks a question of many missions: `mebots sweep` flies them (master/python/mebots/exploration). Here is the
/// reader of its file, which knows no mission and opens no FMU.
namespace mebots::master::study {

/// The content of a study file, everything in it checked that the file alone can tell. Throws data::Mistakes with
/// everything that is wrong.
nlohmann::ordered_json read(const std::filesystem::path& file);
/// The same of a text that would stand in `file`.
nlohmann::ordered_json read(const std::string& text, const std::filesystem::path& file);

}  // namespace mebots::master::study
