// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// Unpacks an FMU of version 2.0 into `folder` and returns its description. Appends notices about the archive to
/// `notices`. Throws InputError if the file is not such an FMU.
modeldesc::ModelDescription unpack_fmu(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                       std::vector<std::string>& notices);

/// Returns the description of an FMU of version 2.0 without unpacking the FMU. Throws InputError if the file is not
/// such an FMU.
modeldesc::ModelDescription read_fmu_description(const std::filesystem::path& archive);

/// Reads descriptions from FMU archives without unpacking them. Each description is read only once.
class FmuDescriptions {
 public:
  /// Returns the description of an FMU. Returns null if the file does not contain a description of FMI 2.0. In this
  /// case, read_fmu_description() throws an error that states the reason.
  const modeldesc::ModelDescription* find(const std::filesystem::path& archive);

 private:
  std::map<std::filesystem::path, std::optional<modeldesc::ModelDescription>> known_;
};

}  // namespace mebots::master
