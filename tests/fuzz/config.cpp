// SPDX-License-Identifier: Apache-2.0
//
// Any text as a config: refused with an InputError, or a system whose times fit each other.
#include "mebots/master/input_error.hpp"
#include "mebots/master/system_description.hpp"
#include "mebots/modeldesc/archive.hpp"

#include "require.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;

struct Place {
  mebots::modeldesc::TemporaryFolder folder{"mebots-fuzz", fs::exists("/dev/shm") ? "/dev/shm" : ""};
  fs::path file = folder.path() / "config.json";
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using mebots::fuzz::require;
  static const Place place;
  {
    std::ofstream stream(place.file, std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  }
  try {
    const auto system = mebots::master::read_config(place.file);
    require(system.step_ns > 0, "the step is above 0");
    require(system.stop_time_ns >= 0 && system.stop_time_ns % system.step_ns == 0, "the end is a communication point");
    require(!system.instances.empty(), "there are instances");
    for (const auto& instance : system.instances)
      require(instance.step_ns > 0 && instance.step_ns % system.step_ns == 0, "an instance's step is a multiple");
  } catch (const mebots::master::InputError&) {
  }
  return 0;
}
