// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>
#include <map>
#include <optional>

namespace mebots::master {

/// Descriptions of FMUs, read from their archives without unpacking them. Each is read once.
class FmuDescriptions {
 public:
  /// Returns null if the file's description cannot be read as one of FMI 2.0. Opening the FMU then gives the reason.
  const modeldesc::ModelDescription* find(const std::filesystem::path& archive);

 private:
  std::map<std::filesystem::path, std::optional<modeldesc::ModelDescription>> known_;
};

}  // namespace mebots::master
