// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace mebots::master::study {

/// What the missions of a study stand on: a config that needs no other file to be understood, and what it depends on.
struct Ground {
  nlohmann::ordered_json config;  ///< of an SSP too; FMUs by absolute path
  nlohmann::ordered_json fmus;    ///< instance -> absolute path
  nlohmann::ordered_json texts;   ///< instance.parameter -> text, which may name a file
  double stop_time_s = 0;
  double last_point_s = 0;  ///< of the communication points before the stop time
  std::shared_ptr<const modeldesc::TemporaryFolder>
      unpacked;  ///< where an SSP's FMUs lie, as long as this object lives
};

/// Reads a mission's config or SSP, or `text` in place of what `mission` holds. Throws InputError.
Ground read_ground(const std::filesystem::path& mission, const std::optional<std::string>& text);

}  // namespace mebots::master::study
