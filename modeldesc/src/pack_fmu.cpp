// SPDX-License-Identifier: Apache-2.0
#include "pack_fmu.hpp"

#include "generate.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "mebots/modeldesc/pe_library.hpp"
#include "mebots/modeldesc/platform.hpp"
#include "mebots/modeldesc/system_libraries.hpp"
#include "mebots/modeldesc/xml.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <map>
#include <set>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;

/// Returns the libraries that `file` needs and that the operating system does not contain.
std::vector<std::string> needs_of(const fs::path& file, BinaryFormat format) {
  auto needed = format == BinaryFormat::pe ? read_pe_library(file).needed : read_elf_library(file).needed;
  std::erase_if(needed, [&](const std::string& name) {
    return format == BinaryFormat::pe ? is_part_of_windows(name) : is_part_of_linux(name);
  });
  return needed;
}

void check_needs(const fs::path& file, BinaryFormat format, const std::map<std::string, fs::path>& bundled) {
  for (const std::string& needed : needs_of(file, format))
    if (!bundled.contains(needed))
      throw Error(
          ErrorCode::invalid_argument,
          fmt::format("{} needs {}, which is not packed into the FMU; add it with --library (BUNDLE in mebots_add_fmu)",
                      file.string(), needed));
}

/// Returns the name under which the loader searches for a library.
std::string loaded_name(const fs::path& library, BinaryFormat format) {
  std::string soname;
  if (format == BinaryFormat::elf) soname = read_elf_library(library).soname;
  return soname.empty() ? library.filename().string() : soname;
}

void add_folder(const fs::path& folder, const std::string& target, std::vector<PackedFile>& files) {
  if (!is_folder(folder))
    throw Error(ErrorCode::file_not_found, fmt::format("{}: there is no such folder", folder.string()));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files.push_back({target + entry.path().lexically_relative(folder).generic_string(), entry.path()});
}

/// The attributes of a modelDescription.xml that determine the archive's layout and documents.
struct Subject {
  bool is_fmi3 = false;
  std::string name;
  std::string version;
  std::string model_identifier;
};

Subject read_subject(const fs::path& file) {
  const std::string text = xml_as_utf8(text_of(file), file.string());
  pugi::xml_document document;
  parse_xml(document, text, file.string());
  const auto root = document.document_element();
  const auto co_simulation = root.child("CoSimulation");
  if (!co_simulation)
    throw Error(ErrorCode::fmu_unsupported, fmt::format("{}: there is no <CoSimulation>", file.string()));
  return {std::string_view(root.attribute("fmiVersion").value()).starts_with("3."), root.attribute("modelName").value(),
          root.attribute("version").value(), co_simulation.attribute("modelIdentifier").value()};
}

/// Adds the terminals and the icon, whose path in the archive depends on the version of FMI, to `files`.
void add_versioned(const FmuParts& parts, const Subject& subject, std::vector<PackedFile>& files) {
  if (!parts.icon.empty()) files.push_back({subject.is_fmi3 ? "terminalsAndIcons/icon.png" : "model.png", parts.icon});
  std::error_code error;
  if (!parts.terminals.empty() && fs::file_size(parts.terminals, error) > 0)
    files.push_back({"terminalsAndIcons/terminalsAndIcons.xml", parts.terminals});
}

}  // namespace

void pack_fmu(const fs::path& archive, const FmuParts& parts) {
  const Subject subject = read_subject(parts.description);
  const Platform& platform = platform_of(parts.binary);
  if (platform.format == BinaryFormat::mach_o)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("{}: is a library of macOS, which cannot be packed yet; build it for Linux or Windows",
                            parts.binary.string()));
  const std::string binaries = fmt::format("binaries/{}/", platform.folder(subject.is_fmi3));

  std::vector<PackedFile> files;
  files.push_back({"modelDescription.xml", parts.description});
  files.push_back({"documentation/index.html", parts.documentation});
  files.push_back({fmt::format("{}{}{}", binaries, subject.model_identifier, platform.suffix), parts.binary});

  std::map<std::string, fs::path> bundled;
  for (const fs::path& library : parts.libraries)
    bundled.emplace(loaded_name(library, platform.format), fs::canonical(library));
  check_needs(parts.binary, platform.format, bundled);
  for (const auto& [name, library] : bundled) {
    check_needs(library, platform.format, bundled);
    files.push_back({binaries + name, library});
  }

  add_versioned(parts, subject, files);
  if (!parts.license.empty()) files.push_back({"documentation/licenses/license.txt", parts.license});
  const auto others = parts.parts.empty() ? std::vector<Part>{} : read_parts(parts.parts);
  std::set<std::string> licensed;  // libraries of one package share its licence
  for (const Part& part : others)
    if (!part.text.empty() && licensed.insert(part.name).second)
      files.push_back({fmt::format("documentation/licenses/{}.txt", part.name), part.text});
  const TemporaryFolder made("mebots-pack");
  const auto bill = made.path() / "sbom.spdx.json";
  write_text_file(bill, spdx_document({subject.name, subject.version, parts.license_id}, others));
  files.push_back({"documentation/sbom.spdx.json", bill});
  if (!parts.reference.empty()) add_folder(parts.reference, "documentation/reference/", files);
  for (const fs::path& folder : parts.resource_folders) add_folder(folder, "resources/", files);
  if (!parts.sources.empty()) add_folder(parts.sources, "sources/", files);
  for (const fs::path& file : parts.resource_files) files.push_back({"resources/" + file.filename().string(), file});

  std::error_code error;
  if (archive.has_parent_path()) fs::create_directories(archive.parent_path(), error);
  if (error)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: the folder cannot be created: {}", archive.parent_path().string(), error.message()));
  pack(archive, std::move(files));
}

}  // namespace mebots::modeldesc
