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
  config::read_scenario_file(document.root(), system);
  return fmt::format("scenario {} {}", file.filename().string(), sha256(text));
}

}  // namespace mebots::master
