// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>

namespace mebots::master {

inline constexpr std::string_view kSystemFile = "system.json";
inline constexpr std::string_view kSceneFile = "scene.json.gz";

/// Returns the content of system.json, which describes the system for tools that show its results: instances with their
/// models, connections with their units, recorded variables with type, unit, description and enumeration items, and the
/// section `view`. Throws InputError if a name under `view` is not a variable.
///
/// system.json exists from t = 0 on, even if the run is in progress or failed. Therefore it is separate from
/// summary.json, which is written at the end.
nlohmann::ordered_json system_json(const ResolvedSystem& system);

/// Writes system.json at t = 0, and the scene named under `view` as scene.json.gz, because its textures are long and
/// compress well.
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
