// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// Unpacks an FMU of version 2.0 and reads its description. `notices` gets notices about the archive. Throws InputError
/// if the file is not such an FMU.
modeldesc::ModelDescription unpack_fmu(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                       std::vector<std::string>& notices);

/// Reads the description of an FMU of version 2.0 without unpacking the rest. Throws InputError if the file is not such
/// an FMU.
modeldesc::ModelDescription read_fmu_description(const std::filesystem::path& archive);

/// Descriptions of FMUs, read from their archives without unpacking. Each description is read once.
class FmuDescriptions {
 public:
  /// Returns null if the file's description cannot be read as a description of FMI 2.0. In this case,
  /// read_fmu_description() throws an error with the reason.
  const modeldesc::ModelDescription* find(const std::filesystem::path& archive);

 private:
  std::map<std::filesystem::path, std::optional<modeldesc::ModelDescription>> known_;
};

}  // namespace mebots::master
