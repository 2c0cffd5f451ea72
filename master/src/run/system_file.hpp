// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>

namespace mebots::master {

inline constexpr std::string_view kSystemFile = "system.json";
inline constexpr std::string_view kSceneFile = "scene.json.gz";

/// Returns the content of system.json, which tools need to show results: instances, connections, recorded variables
/// with type, unit and description, and the section `view`. Throws InputError if a name under `view` is not a variable.
/// Unlike summary.json, system.json exists from the start of a run.
nlohmann::ordered_json system_json(const ResolvedSystem& system);

/// An observer that writes system.json at the start. Also writes the scene that `view` names to scene.json.gz. The
/// scene is compressed, because it contains textures.
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
