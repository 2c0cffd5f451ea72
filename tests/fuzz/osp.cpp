// SPDX-License-Identifier: Apache-2.0
//
// Any files as an OspSystemStructure.xml and what lies beside it, among them two FMUs: refused with an InputError, or a
// system whose parts fit each other.
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/archive.hpp"

#include "config/system_file.hpp"
#include "folder_of_input.hpp"
#include "system.hpp"

#include <cstdint>
#include <filesystem>

namespace {

using namespace mebots;

/// Two FMUs without code: it is their descriptions that are asked.
const std::filesystem::path& fmus() {
  static const auto folder = fuzz::fast_folder();
  static const bool made = [] {
    for (const auto* name : {"probe", "coupling"}) {
      modeldesc::pack(folder.path() / (std::string(name) + ".fmu"),
                      {{"modelDescription.xml",
                        std::filesystem::path(MEBOTS_SOURCE_DIR) / "tests/fmus" / (std::string(name) + ".xml")}});
    }
    return true;
  }();
  fuzz::require(made, "the FMUs are there");
  return folder.path();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto folder = fuzz::fast_folder();
  for (const auto& fmu : std::filesystem::directory_iterator(fmus()))
    std::filesystem::create_symlink(fmu.path(), folder.path() / fmu.path().filename());
  fuzz::write_files({reinterpret_cast<const char*>(data), size}, "OspSystemStructure.xml", folder.path());
  try {
    fuzz::require_sound(master::load_system(folder.path() / "OspSystemStructure.xml", {0.001, 1.0}).system);
  } catch (const InputError&) {
  }
  return 0;
}
