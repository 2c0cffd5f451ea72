// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace mebots::master::study {

/// The config from which a study derives its missions. It is complete and refers to no other config. FMUs are listed
/// separately, and so are texts of parameters, because they may name files.
struct BaseConfig {
  nlohmann::ordered_json config;  ///< converted if the mission is an SSP; paths of FMUs are absolute
  nlohmann::ordered_json fmus;    ///< maps instances to absolute paths
  nlohmann::ordered_json texts;   ///< maps instance.parameter to its text, which may name a file
  double stop_time_s = 0;
  double last_point_s = 0;  ///< the last communication point before the stop time
  std::shared_ptr<const modeldesc::TemporaryFolder>
      unpacked;  ///< the folder that contains an SSP's FMUs; deleted together with this object
};

/// Reads the config or SSP of a mission. If `text` is given, reads it in place of the content of the file `mission`.
/// Throws InputError if there is a mistake.
BaseConfig read_base_config(const std::filesystem::path& mission, const std::optional<std::string>& text);

}  // namespace mebots::master::study
