// SPDX-License-Identifier: Apache-2.0
// Reads any text as a rotor file. The reader must throw Error, or return a rotor.
#include "rotor_data.hpp"

#include "mebots/error.hpp"
#include "memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static mebots::fuzz::MemoryFile file;
  try {
    mebots::motors::load_rotor(file.with(data, size));
  } catch (const mebots::Error&) {
  }
  return 0;
}
