// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace mebots::master {

/// The forms in which a system can be described.
enum class SystemForm {
  config,  ///< JSON
  fmu,     ///< an FMU alone, `.fmu`: the system of this one instance
  ssp,     ///< an SSP archive, `.ssp`
  ssd,     ///< an unpacked SSP, by its `.ssd`
  osp,     ///< OspSystemStructure.xml
};

/// The file that describes a system, and its form.
struct SystemFile {
  std::filesystem::path path;
  SystemForm form;
};

/// By the file's ending; in a folder, by the SystemStructure.ssd or OspSystemStructure.xml that it holds. Throws
/// InputError for a folder with neither.
SystemFile find_system(const std::filesystem::path& path);

/// True for what find_system() takes, by its name alone, so that an FMU is none.
bool may_be_system(const std::filesystem::path& path);

/// What the system is called after: the folder of an unpacked SSP or of an OSP system whose file has the usual name,
/// else the file's name without its ending.
std::string system_name(const std::filesystem::path& path);

}  // namespace mebots::master
