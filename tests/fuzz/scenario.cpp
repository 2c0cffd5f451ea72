// SPDX-License-Identifier: Apache-2.0
// Reads any text as a scenario file, first without a system, then for a system of four instances. Each reader must
// throw Error or accept the text. For the system, all overrides must be of existing instances. After an Error, the
// system must have no overrides.
#include "io/config/load_system.hpp"
#include "mebots/error.hpp"
#include "memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mebots;
  static fuzz::MemoryFile file;
  const auto& path = file.with(data, size);
  try {
    master::config::check_scenario(path);
  } catch (const Error&) {
  }
  master::SystemDescription system;
  system.step = {1, 1000};
  system.stop_time_ns = 1'000'000'000;
  for (const auto* name : {"battery", "motors", "world", "soc"}) system.instances.emplace_back().name = name;
  try {
    master::apply_scenario(system, path);
    for (const auto& override : system.scenario)
      fuzz::require(system.find_instance(override.variable.instance) != nullptr, "an override is of an instance");
  } catch (const Error&) {
    fuzz::require(system.scenario.empty(), "all of the file or nothing");
  }
  return 0;
}
