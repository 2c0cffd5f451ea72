// SPDX-License-Identifier: Apache-2.0
#include "config/scenario_file.hpp"

#include "base/input_text.hpp"
#include "config/json_document.hpp"
#include "config/sections.hpp"
#include "run/input_hash.hpp"

#include <fmt/format.h>

namespace mebots::master {

std::string apply_scenario(SystemDescription& system, const std::filesystem::path& file) {
  const auto text = input_text(file);
  const JsonDocument document(text, file.string());
  auto changed = system;  // all of the file or nothing
  config::read_scenario_file(document.root(), changed);
  system = std::move(changed);
  return fmt::format("scenario {} {}", file.filename().string(), sha256(text));
}

}  // namespace mebots::master
