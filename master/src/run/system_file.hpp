// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>

namespace mebots::master {

inline constexpr std::string_view kSystemFile = "system.json";
inline constexpr std::string_view kSceneFile = "scene.json.gz";

/// Returns the content of system.json, which describes the system for tools that show its results. It contains the
/// instances and their models, the connections and their units, the recorded variables (type, unit, description,
/// enumeration items), and the section `view`. Throws InputError if a name under `view` is not a variable.
///
/// system.json exists from t = 0, even if the run is in progress or failed. Therefore it is separate from summary.json,
/// which is written at the end.
nlohmann::ordered_json system_json(const ResolvedSystem& system);

/// Writes system.json at t = 0. Also writes the scene named under `view` to scene.json.gz; it is compressed, because
/// its textures are long.
class SystemFileWriter final : public Observer {
 public:
  /// Throws InputError if the scene is not a String. All arguments must outlive this object.
  SystemFileWriter(const ResolvedSystem& system, Ensemble& ensemble, std::filesystem::path folder);

  std::optional<std::string> reached(const Point& point) override;

 private:
  Ensemble* ensemble_;
  std::filesystem::path folder_;
  std::string system_text_;
  std::optional<ResolvedVariable> scene_;
};

}  // namespace mebots::master
