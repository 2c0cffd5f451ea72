// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>

namespace mebots::master {

inline constexpr std::string_view kSystemFile = "system.json";
inline constexpr std::string_view kSceneFile = "scene.json.gz";

/// The content of system.json: what the results are results of, for whoever shows them. Instances with their models,
/// connections with their units, recorded variables with type, unit, meaning and the items of their enumerations, and
/// what the config says under `view`. Throws InputError for names under `view` that no FMU has.
///
/// It is not part of summary.json, which comes with the end: this is known at t = 0, also of a run that is being
/// watched or that never came to its end.
nlohmann::ordered_json system_json(const ResolvedSystem& system);

/// Writes system.json at t = 0, and the scene that the config names under `view` as scene.json.gz: its textures are
/// long, and mostly alike.
class SystemFileWriter final : public Observer {
 public:
  /// Throws InputError for a scene that is not a String. All must outlive this object.
  SystemFileWriter(const ResolvedSystem& system, Ensemble& ensemble, std::filesystem::path folder);

  std::optional<std::string> reached(const Point& point) override;

 private:
  Ensemble* ensemble_;
  std::filesystem::path folder_;
  std::string system_text_;
  std::optional<ResolvedVariable> scene_;
};

}  // namespace mebots::master
