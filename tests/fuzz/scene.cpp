// SPDX-License-Identifier: Apache-2.0
// Reads any text as a scene, as a drone and as networks of downwash. The readers must throw Error, or return the data.
#include "scene/downwash_networks.hpp"
#include "scene/load.hpp"

#include "mebots/error.hpp"
#include "memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static mebots::fuzz::MemoryFile file;
  const auto& path = file.with(data, size);
  try {
    mebots::world::scene::load_scene(path);
  } catch (const mebots::Error&) {
  }
  try {
    mebots::world::scene::load_drone(path);
  } catch (const mebots::Error&) {
  }
  try {
    static_cast<void>(mebots::world::scene::load_downwash_networks(path));
  } catch (const mebots::Error&) {
  }
  return 0;
}
