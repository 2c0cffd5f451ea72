// SPDX-License-Identifier: Apache-2.0
//
// Reads any text as a config. The reader must throw InputError, or return a consistent system. FMUs must exist, so the
// corpus uses the root folder as an FMU: the reader of configs does not open FMUs.
#include "mebots/input_error.hpp"

#include "io/config/load_system.hpp"
#include "system.hpp"

#include <cstdint>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto loaded = mebots::master::config::load_text({reinterpret_cast<const char*>(data), size}, "/config.json");
    mebots::fuzz::require_sound(loaded.system);
  } catch (const mebots::InputError&) {
  }
  return 0;
}
