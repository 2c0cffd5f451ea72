// SPDX-License-Identifier: Apache-2.0
#include "io/config/scenario_file.hpp"

#include "base/input_text.hpp"
#include "base/sha256.hpp"
#include "io/config/sections.hpp"
#include "mebots/data/document.hpp"

#include <fmt/format.h>

namespace mebots::master {

std::string apply_scenario(SystemDescription& system, const std::filesystem::path& file) {
  const auto text = input_text(file);
  auto changed = system;  // all of the file or nothing
  refused_as_input([&] {
    data::Document(text, file.string()).read([&](const data::Node& root) {
      config::read_scenario_file(root, changed, std::filesystem::absolute(file).parent_path());
    });
  });
  system = std::move(changed);
  return fmt::format("scenario {} {}", file.filename().string(), sha256(text));
}

}  // namespace mebots::master
