// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace mebots::master::study {

/// The config of a study's missions. It is complete and refers to no other config. `fmus` and `texts` contain the
/// values that may name files.
struct BaseConfig {
  nlohmann::ordered_json config;  ///< JSON of the config or SSP; paths of FMUs are absolute
  nlohmann::ordered_json fmus;    ///< absolute path for each instance
  nlohmann::ordered_json texts;   ///< text for each instance.parameter; may be the name of a file
  double stop_time_s = 0;
  double last_point_s = 0;  ///< last communication point before the stop time
  std::shared_ptr<const modeldesc::TemporaryFolder>
      unpacked;  ///< the folder that contains an SSP's FMUs; deleted together with this object
};

/// Reads the config or SSP of a mission. If `text` is given, reads `text` instead of the file. Throws InputError if
/// there is a mistake.
BaseConfig read_base_config(const std::filesystem::path& mission, const std::optional<std::string>& text);

}  // namespace mebots::master::study
