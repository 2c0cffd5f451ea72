// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/archive.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace mebots::master::study {

/// The config from which a study derives its missions, complete in itself, and the files that it depends on.
struct BaseConfig {
  nlohmann::ordered_json config;  ///< of an SSP too; FMUs by absolute path
  nlohmann::ordered_json fmus;    ///< instance -> absolute path
  nlohmann::ordered_json texts;   ///< instance.parameter -> text, which may name a file
  double stop_time_s = 0;
  double last_point_s = 0;  ///< of the communication points before the stop time
  std::shared_ptr<const modeldesc::TemporaryFolder>
      unpacked;  ///< the folder of an SSP's FMUs; removed with this object
};

/// Reads a mission's config or SSP, or `text` instead of the content of `mission`. Throws InputError.
BaseConfig read_base_config(const std::filesystem::path& mission, const std::optional<std::string>& text);

}  // namespace mebots::master::study
