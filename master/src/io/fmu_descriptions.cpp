// SPDX-License-Identifier: Apache-2.0
#include "io/fmu_descriptions.hpp"

#include "mebots/error.hpp"
#include "mebots/modeldesc/archive_reader.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <algorithm>
#include <string>

namespace mebots::master {
namespace {

std::optional<modeldesc::ModelDescription> read_description(const std::filesystem::path& archive) {
  try {
    const modeldesc::ArchiveReader reader(modeldesc::open_zip(archive), archive.string());
    const auto entry =
        std::ranges::find(reader.entries(), "modelDescription.xml", &modeldesc::ArchiveReader::Entry::name);
    if (entry == reader.entries().end()) return std::nullopt;
    std::string text;
    reader.read(*entry, [&](std::string_view part) { text += part; });
    return modeldesc::read_xml_text(text, archive.string());
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

const modeldesc::ModelDescription* FmuDescriptions::find(const std::filesystem::path& archive) {
  auto known = known_.find(archive);
  if (known == known_.end()) known = known_.emplace(archive, read_description(archive)).first;
  return known->second ? &*known->second : nullptr;
}

}  // namespace mebots::master
