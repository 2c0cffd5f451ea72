// SPDX-License-Identifier: Apache-2.0
#include "io/study/base_config.hpp"

#include "io/config/load_system.hpp"
#include "model/system_description.hpp"

#include <variant>

namespace mebots::master::study {

BaseConfig read_base_config(const std::filesystem::path& mission, const std::optional<std::string>& text) {
  auto loaded = text ? config::load_text(*text, mission) : load_system(mission);
  const auto grid = loaded.system.grid();
  const auto last = grid.point_at(loaded.system.stop_time_ns);
  BaseConfig base{.config = std::move(loaded.config),
                  .fmus = nlohmann::ordered_json::object(),
                  .texts = nlohmann::ordered_json::object(),
                  .stop_time_s = grid.time_s(loaded.system.stop_time_ns),
                  .last_point_s = grid.time_s(grid.time_ns(last - 1)),
                  .unpacked = loaded.system.unpacked};
  base.config.erase("$schema");
  config::make_signal_paths_absolute(base.config, loaded.system);  // missions read the config from another folder
  for (const auto& instance : loaded.system.instances) {
    base.fmus[instance.name] = instance.fmu_path.string();
    base.config["instances"][instance.name]["fmu"] = instance.fmu_path.string();
    for (const auto& assignment : instance.parameters) {
      const auto* value = std::get_if<std::string>(&assignment.value);
      if (value != nullptr) base.texts[instance.name + "." + assignment.variable] = *value;
    }
  }
  return base;
}

}  // namespace mebots::master::study
