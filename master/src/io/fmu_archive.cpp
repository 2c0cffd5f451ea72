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

constexpr const char* kDescription = "modelDescription.xml";

/// Returns the text of modelDescription.xml without unpacking other files; nullopt if it is not at the root of the
/// archive.
std::optional<std::string> description_text(const std::filesystem::path& archive) {
  const modeldesc::ArchiveReader reader(modeldesc::open_zip(archive), archive.string());
  const auto entry = std::ranges::find(reader.entries(), kDescription, &modeldesc::ArchiveReader::Entry::name);
  if (entry == reader.entries().end()) return std::nullopt;
  std::string text;
  reader.read(*entry, [&](std::string_view part) { text += part; });
  return text;
}

std::optional<modeldesc::ModelDescription> read_description(const std::filesystem::path& archive) {
  try {
    const auto text = description_text(archive);
    if (!text) return std::nullopt;
    return modeldesc::read_xml_text(*text, archive.string());
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Throws InputError with the name of the archive instead of the unpacked file.
[[noreturn]] void throw_as_input(const Error& error, const std::filesystem::path& archive,
                                 const std::filesystem::path& file) {
  std::string what = error.what();
  const auto at = what.find(file.string());
  if (at != std::string::npos) what.replace(at, file.string().size(), kDescription);
  if (what.find(archive.string()) == std::string::npos) what = fmt::format("{}: {}", archive.string(), what);
  throw InputError(error.code(), what);
}

}  // namespace

modeldesc::ModelDescription unpack_fmu(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                       std::vector<std::string>& notices) {
  const auto file = folder / kDescription;
  try {
    notices = modeldesc::unpack(archive, folder);
    if (!is_there(file)) {
      throw InputError(ErrorCode::fmu_inconsistent,
                       fmt::format("{}: this is not an FMU: {}", archive.string(),
                                   modeldesc::why_missing(folder, file.filename().string())));
    }
    return modeldesc::read_xml(file);
  } catch (const InputError&) {
    throw;
  } catch (const Error& error) {
    throw_as_input(error, archive, file);
  }
}

modeldesc::ModelDescription read_fmu_description(const std::filesystem::path& archive) {
  try {
    if (const auto text = description_text(archive)) return modeldesc::read_xml_text(*text, kDescription);
  } catch (const InputError&) {
    throw;
  } catch (const Error& error) {
    throw_as_input(error, archive, kDescription);
  }
  // Unpacks the whole archive, because the error message contains the names of its files.
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
