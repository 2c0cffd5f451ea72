// SPDX-License-Identifier: Apache-2.0
//
// Reads any files as an OspSystemStructure.xml and the files next to it, including two FMUs. The reader must throw
// InputError, or return a consistent system.
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/archive.hpp"

#include "folder_of_input.hpp"
#include "io/config/load_system.hpp"
#include "system.hpp"

#include <cstdint>
#include <filesystem>

namespace {

using namespace mebots;

/// A folder with two FMUs. They contain no code, because only their descriptions are read.
class FolderWithFmus : public fuzz::FolderOfInput {
 public:
  FolderWithFmus() {
    for (const auto* name : {"probe", "coupling"}) {
      modeldesc::pack(path() / (std::string(name) + ".fmu"),
                      {{"modelDescription.xml",
                        std::filesystem::path(MEBOTS_SOURCE_DIR) / "tests/fmus" / (std::string(name) + ".xml")}});
    }
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static FolderWithFmus folder;
  folder.fill({reinterpret_cast<const char*>(data), size}, "OspSystemStructure.xml");
  try {
    fuzz::require_sound(master::load_system(folder.path() / "OspSystemStructure.xml", {0.001, 1.0}).system);
  } catch (const InputError&) {
  }
  folder.clear();
  return 0;
}
