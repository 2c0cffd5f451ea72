// SPDX-License-Identifier: Apache-2.0
#include "study/ground.hpp"

#include "config/from_memory.hpp"
#include "config/system_description.hpp"

#include <variant>

namespace mebots::master::study {

Ground read_ground(const std::filesystem::path& mission, const std::optional<std::string>& text) {
  auto loaded = text ? config::load_text(*text, mission) : load_system(mission);
  Ground ground{std::move(loaded.config), nlohmann::ordered_json::object(), nlohmann::ordered_json::object(),
                loaded.system.unpacked};
  ground.config.erase("$schema");
  for (const auto& instance : loaded.system.instances) {
    ground.fmus[instance.name] = instance.fmu_path.string();
    ground.config["instances"][instance.name]["fmu"] = instance.fmu_path.string();
    for (const auto& assignment : instance.parameters) {
      const auto* value = std::get_if<std::string>(&assignment.value);
      if (value != nullptr) ground.texts[instance.name + "." + assignment.variable] = *value;
    }
  }
  return ground;
}

}  // namespace mebots::master::study
