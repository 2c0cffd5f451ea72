// SPDX-License-Identifier: Apache-2.0
#include "io/fmu_terminals.hpp"

#include "mebots/modeldesc/archive_reader.hpp"

#include <string>

namespace mebots::master {

std::vector<modeldesc::DeclaredTerminal> read_fmu_terminals(const std::filesystem::path& archive) {
  constexpr const char* kEntry = "terminalsAndIcons/terminalsAndIcons.xml";
  const modeldesc::ArchiveReader reader(modeldesc::open_zip(archive), archive.string());
  for (const auto& entry : reader.entries()) {
    if (entry.name != kEntry) continue;
    std::string text;
    reader.read(entry, [&](std::string_view part) { text += part; });
    return modeldesc::read_terminals(text, kEntry);
  }
  return {};
}

}  // namespace mebots::master
