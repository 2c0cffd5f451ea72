// SPDX-License-Identifier: Apache-2.0
#include "pack_fmu.hpp"

#include "generate.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;

/// Libraries that every desktop or server Linux of our C library has, and those that a sanitizer build brings in.
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
          fmt::format("{} needs {}, which does not travel in the FMU; add it with --library (BUNDLE in mebots_add_fmu)",
                      file.string(), needed));
}

void add_folder(const fs::path& folder, const std::string& target, std::vector<PackedFile>& files) {
  if (!is_folder(folder))
    throw Error(ErrorCode::file_not_found, fmt::format("{}: there is no such folder", folder.string()));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files.push_back({target + entry.path().lexically_relative(folder).generic_string(), entry.path()});
}

}  // namespace

void pack_fmu(const fs::path& archive, const FmuParts& parts) {
  const ModelDescription description = read_xml(parts.description);
  if (!description.co_simulation)
    throw Error(ErrorCode::fmu_unsupported, fmt::format("{}: has no <CoSimulation>", parts.description.string()));
  const std::string binaries = "binaries/linux64/";

  std::vector<PackedFile> files;
  files.push_back({"modelDescription.xml", parts.description});
  files.push_back({"documentation/index.html", parts.documentation});
  files.push_back({binaries + description.co_simulation->model_identifier + ".so", parts.binary});

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

  if (!parts.icon.empty()) files.push_back({"model.png", parts.icon});
  if (!parts.license.empty()) files.push_back({"documentation/licenses/license.txt", parts.license});
  const auto others = parts.parts.empty() ? std::vector<Part>{} : read_parts(parts.parts);
  std::set<std::string> licensed;  // two libraries of one package share its licence
  for (const Part& part : others)
    if (!part.text.empty() && licensed.insert(part.name).second)
      files.push_back({fmt::format("documentation/licenses/{}.txt", part.name), part.text});
  const TemporaryFolder made("mebots-pack");
  const auto bill = made.path() / "sbom.spdx.json";
  write_text_file(bill, spdx_document({description.model_name, description.version, parts.license_id}, others));
  files.push_back({"documentation/sbom.spdx.json", bill});
  if (!parts.reference.empty()) add_folder(parts.reference, "documentation/reference/", files);
  for (const fs::path& folder : parts.resource_folders) add_folder(folder, "resources/", files);
  for (const fs::path& file : parts.resource_files) files.push_back({"resources/" + file.filename().string(), file});

  std::error_code error;
  if (archive.has_parent_path()) fs::create_directories(archive.parent_path(), error);
  if (error)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: the folder cannot be made: {}", archive.parent_path().string(), error.message()));
  pack(archive, std::move(files));
}

}  // namespace mebots::modeldesc
