// SPDX-License-Identifier: Apache-2.0
#include "new_folder.hpp"

namespace mebots::new_folder {

std::filesystem::path new_firmware(const std::string& name, Language language, std::filesystem::path folder) {
  require_name(name);
  if (folder.empty()) folder = name;
  write_folder(folder,
               read_template(language == Language::rust ? "my_firmware_rust" : "my_firmware", {{"my_firmware", name}}));
  return folder;
}

}  // namespace mebots::new_folder
