// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace mebots::master::study {

/// The config from which a study derives its missions. It refers to no other config. The FMUs, and the texts of
/// parameters, which may name files, are listed separately.
struct BaseConfig {
  nlohmann::ordered_json config;  ///< also for an SSP; FMUs by absolute path
  nlohmann::ordered_json fmus;    ///< instance -> absolute path
  nlohmann::ordered_json texts;   ///< maps instance.parameter to its text, which may name a file
  double stop_time_s = 0;
  double last_point_s = 0;  ///< the last communication point before the stop time
  std::shared_ptr<const modeldesc::TemporaryFolder>
      unpacked;  ///< the folder with an SSP's FMUs; deleted with this object
};

/// Reads a mission's config or SSP. If `text` is given, uses `text` in place of the content of the file `mission`.
/// Throws InputError.
BaseConfig read_base_config(const std::filesystem::path& mission, const std::optional<std::string>& text);

}  // namespace mebots::master::study
