// SPDX-License-Identifier: Apache-2.0
#include "io/fmu_archive.hpp"

#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/archive_reader.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>

#include <algorithm>

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

modeldesc::ModelDescription unpack_fmu(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                       std::vector<std::string>& notices) {
  const auto file = folder / "modelDescription.xml";
  try {
    notices = modeldesc::unpack(archive, folder);
    if (!is_there(file)) {
      throw InputError(ErrorCode::fmu_inconsistent,
                       fmt::format("{}: this is not an FMU: {}", archive.string(),
                                   modeldesc::why_missing(folder, file.filename().string())));
    }
    auto description = modeldesc::read_xml(file);
    if (description.fmi_version != "2.0") {
      throw InputError(ErrorCode::fmu_unsupported,
                       fmt::format("{}: this FMU is of FMI version '{}'; FMI 2.0 is supported", archive.string(),
                                   description.fmi_version));
    }
    return description;
  } catch (const InputError&) {
    throw;
  } catch (const Error& error) {
    // Name the archive rather than the temporary copy of the file inside it.
    std::string what = error.what();
    const auto at = what.find(file.string());
    if (at != std::string::npos) what.replace(at, file.string().size(), "modelDescription.xml");
    if (what.find(archive.string()) == std::string::npos) what = fmt::format("{}: {}", archive.string(), what);
    throw InputError(error.code(), what);
  }
}

modeldesc::ModelDescription read_fmu_description(const std::filesystem::path& archive) {
  const modeldesc::TemporaryFolder folder("mebots");
  std::vector<std::string> notices;
  return unpack_fmu(archive, folder.path(), notices);
}

const modeldesc::ModelDescription* FmuDescriptions::find(const std::filesystem::path& archive) {
  auto known = known_.find(archive);
  if (known == known_.end()) known = known_.emplace(archive, read_description(archive)).first;
  return known->second ? &*known->second : nullptr;
}

}  // namespace mebots::master
