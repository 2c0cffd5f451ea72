// SPDX-License-Identifier: Apache-2.0
#include "pack_fmu.hpp"

#include "generate.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "mebots/modeldesc/xml.hpp"
#include "mebots/text_file.hpp"

#include <elf.h>
#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;

/// True for libraries that every desktop or server Linux with our C library has, and for those of sanitizers.
bool is_part_of_the_system(std::string_view soname) {
  constexpr std::string_view kPrefixes[] = {
      "libc.so.",      "libm.so.",     "libdl.so.",   "libpthread.so.", "librt.so.",   "ld-linux",
      "libstdc++.so.", "libgcc_s.so.", "libasan.so.", "libubsan.so.",   "libtsan.so.", "liblsan.so.",
  };
  return std::ranges::any_of(kPrefixes, [&](std::string_view prefix) { return soname.starts_with(prefix); });
}

void check_needs(const fs::path& file, const std::map<std::string, fs::path>& bundled) {
  for (const std::string& needed : read_elf_library(file).needed)
    if (!is_part_of_the_system(needed) && !bundled.contains(needed))
      throw Error(
          ErrorCode::invalid_argument,
          fmt::format("{} needs {}, which is not packed into the FMU; add it with --library (BUNDLE in mebots_add_fmu)",
                      file.string(), needed));
}

void add_folder(const fs::path& folder, const std::string& target, std::vector<PackedFile>& files) {
  if (!is_folder(folder))
    throw Error(ErrorCode::file_not_found, fmt::format("{}: there is no such folder", folder.string()));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files.push_back({target + entry.path().lexically_relative(folder).generic_string(), entry.path()});
}

/// The parts of a modelDescription.xml that determine the archive's layout and documents.
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

/// Returns the folder of the library's platform. FMI 2.0 has one name for all 64-bit Linux.
std::string_view platform(const fs::path& binary, bool is_fmi3) {
  if (!is_fmi3) return "linux64";
  return read_elf_library(binary).machine == EM_AARCH64 ? "aarch64-linux" : "x86_64-linux";
}

/// Adds folders and files whose places differ between the versions.
void add_versioned(const FmuParts& parts, const Subject& subject, std::vector<PackedFile>& files) {
  if (!parts.icon.empty()) files.push_back({subject.is_fmi3 ? "terminalsAndIcons/icon.png" : "model.png", parts.icon});
  std::error_code error;
  if (!parts.terminals.empty() && fs::file_size(parts.terminals, error) > 0)
    files.push_back({"terminalsAndIcons/terminalsAndIcons.xml", parts.terminals});
}

}  // namespace

void pack_fmu(const fs::path& archive, const FmuParts& parts) {
  const Subject subject = read_subject(parts.description);
  const std::string binaries = fmt::format("binaries/{}/", platform(parts.binary, subject.is_fmi3));

  std::vector<PackedFile> files;
  files.push_back({"modelDescription.xml", parts.description});
  files.push_back({"documentation/index.html", parts.documentation});
  files.push_back({binaries + subject.model_identifier + ".so", parts.binary});

  std::map<std::string, fs::path> bundled;
  for (const fs::path& library : parts.libraries) {
    const std::string soname = read_elf_library(library).soname;
    bundled.emplace(soname.empty() ? library.filename().string() : soname, fs::canonical(library));
  }
  check_needs(parts.binary, bundled);
  for (const auto& [name, library] : bundled) {
    check_needs(library, bundled);
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
  for (const fs::path& file : parts.resource_files) files.push_back({"resources/" + file.filename().string(), file});

  std::error_code error;
  if (archive.has_parent_path()) fs::create_directories(archive.parent_path(), error);
  if (error)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: the folder cannot be created: {}", archive.parent_path().string(), error.message()));
  pack(archive, std::move(files));
}

}  // namespace mebots::modeldesc
