// SPDX-License-Identifier: Apache-2.0
// Reads any files as an unpacked SSP. The reader must throw InputError, or return a consistent system.
#include "mebots/input_error.hpp"

#include "folder_of_input.hpp"
#include "io/config/load_system.hpp"
#include "system.hpp"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mebots;
  static fuzz::FolderOfInput folder;
  folder.fill({reinterpret_cast<const char*>(data), size}, "SystemStructure.ssd");
  try {
    fuzz::require_sound(master::load_system(folder.path(), {0.001, {}}).system);
  } catch (const InputError&) {
  }
  folder.clear();
  return 0;
}
