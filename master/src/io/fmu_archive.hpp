// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// Unpacks an FMU of FMI 1.0, 2.0 or 3.0 into `folder` and returns its description. Sets `notices` to the notices about
/// the archive. Throws InputError if the file is not such an FMU.
modeldesc::ModelDescription unpack_fmu(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                       std::vector<std::string>& notices);

/// Reads the description of an FMU of FMI 1.0, 2.0 or 3.0 without unpacking the FMU. Throws InputError if the file is
/// not such an FMU.
modeldesc::ModelDescription read_fmu_description(const std::filesystem::path& archive);

/// Reads descriptions from FMU archives, each one only once.
class FmuDescriptions {
 public:
  /// Returns the description of an FMU; null if the file does not contain a valid description. read_fmu_description()
  /// then throws an error with the reason.
  const modeldesc::ModelDescription* find(const std::filesystem::path& archive);

 private:
  std::map<std::filesystem::path, std::optional<modeldesc::ModelDescription>> known_;
};

}  // namespace mebots::master
