// SPDX-License-Identifier: Apache-2.0
#include "checks.hpp"

#include "child.hpp"

#include "fmi/library_state.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/fmi2/library.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "mebots/modeldesc/platform.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace mebots::check {
namespace {

namespace fs = std::filesystem;
using modeldesc::ModelDescription;

using master::FmuKind;

/// True for functions that only the other kind of FMU needs. The other kind (co-simulation or model exchange) may have
/// its own library.
bool is_of_other_kind(fmi2::Need need, FmuKind kind) {
  if (kind == FmuKind::co_simulation) return need == fmi2::Need::to_integrate;
  return need == fmi2::Need::to_step || need == fmi2::Need::co_simulation;
}

bool is_wanted(fmi2::Need need, const modeldesc::Implementation& flags) {
  switch (need) {
    case fmi2::Need::to_run:
    case fmi2::Need::always:
    case fmi2::Need::to_step:
    case fmi2::Need::co_simulation:
    case fmi2::Need::to_integrate:
      return true;
    case fmi2::Need::fmu_state:
      return flags.can_get_and_set_fmu_state;
    case fmi2::Need::serialization:
      return flags.can_serialize_fmu_state;
    case fmi2::Need::directional_derivative:
      return flags.provides_directional_derivative;
  }
  return false;
}

std::set<std::string> exported_names(const fs::path& library) {
  const auto exports = modeldesc::read_elf_library(library).exports();
  return {exports.begin(), exports.end()};
}

/// True for symbols that the linker defines.
bool is_linkers_own(std::string_view name) {
  constexpr std::string_view kOwn[] = {"_init", "_fini", "__bss_start", "_edata", "_end"};
  return std::ranges::find(kOwn, name) != std::end(kOwn);
}

/// Resolves needed libraries as ld.so(8) does: RPATH of the library and of its parents (unless the library has a
/// RUNPATH), LD_LIBRARY_PATH, RUNPATH, and the system's folders. For the system's folders, calls the loader.
class NeededLibraries {
 public:
  NeededLibraries(fs::path folder, Findings findings) : folder_(std::move(folder)), findings_(findings) {}

  void follow(const fs::path& file, std::vector<std::string> inherited) {
    if (!seen_.insert(file.filename().string()).second) return;
    const auto library = modeldesc::read_elf_library(file);
    auto rpath = modeldesc::search_folders(library.rpath, file);
    if (library.runpath.empty()) inherited.insert(inherited.begin(), rpath.begin(), rpath.end());
    const auto runpath = modeldesc::search_folders(library.runpath, file);
    std::vector<std::string> folders = library.runpath.empty() ? inherited : runpath;
    for (const auto& needed : library.needed) resolve(needed, file, folders, inherited);
  }

 private:
  void resolve(const std::string& needed, const fs::path& asking, const std::vector<std::string>& folders,
               const std::vector<std::string>& inherited) {
    for (const auto& folder : folders) {
      const auto candidate = fs::path(folder) / needed;
      if (!is_there(candidate)) continue;
      if (fs::weakly_canonical(candidate).string().starts_with(fs::weakly_canonical(folder_).string())) {
        follow(candidate, inherited);
      } else if (!folder.starts_with("/usr") && !folder.starts_with("/lib") && reported_.insert(needed).second) {
        findings_.warning(fmt::format("{} loads {} from {}, a folder that exists only on this machine",
                                      asking.filename().string(), needed, folder),
                          "put the library into the folder of the FMU's library, and link with -Wl,-rpath,'$ORIGIN'");
      }
      return;
    }
    if (system_has(needed) || !reported_.insert(needed).second) return;
    if (is_there(folder_ / needed)) {
      findings_.error(fmt::format("{1} needs {0} from its own folder, but has no search path for it", needed,
                                  asking.filename().string()),
                      "link with -Wl,-rpath,'$ORIGIN' -Wl,--disable-new-dtags");
      return;
    }
    findings_.error(
        fmt::format("{} is needed by {} and was not found (looked in {}{}the system's folders)", needed,
                    asking.filename().string(), fmt::join(folders, ", "), folders.empty() ? "" : ", "),
        "install its package, or put it into the folder of the FMU's own library and link with -Wl,-rpath,'$ORIGIN'");
  }

  /// True if the loader finds a library of the system. Loads it in a child process, because loading runs its start-up
  /// code.
  static bool system_has(const std::string& needed) {
    Check check;
    run_in_child({.severity = Severity::error, .way_out = "", .deadline_s = 10}, check, [&](Witness& witness) {
      witness.doing(fmt::format("loading {}", needed));
      if (dlopen(needed.c_str(), RTLD_LAZY | RTLD_LOCAL) == nullptr) witness.error(dlerror(), "");
    });
    return check.findings.empty();
  }

  fs::path folder_;
  Findings findings_;
  std::set<std::string> seen_;
  std::set<std::string> reported_;
};

}  // namespace

fs::path library_path(const std::string& identifier, const fs::path& folder) {
  const auto name = identifier + ".so";
  return modeldesc::binaries_folder(folder, false, name) / name;
}

void check_platforms(const ModelDescription& model, const std::string& identifier, const fs::path& folder,
                     Findings findings) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder / "binaries", ignored)) {
    const auto name = entry.path().filename().string();
    const auto platforms = modeldesc::platforms();
    const auto platform = std::ranges::find(platforms, name, &modeldesc::Platform::fmi2_folder);
    if (platform == platforms.end()) {
      findings.warning(fmt::format("binaries/{} is not a platform that FMI {} names", name, model.fmi_version),
                       "it names win32, win64, linux32, linux64, darwin32, darwin64; for others use the names of FMI "
                       "3.0, such as aarch64-linux");
      continue;
    }
    const auto file = fmt::format("{}{}", identifier, platform->suffix);
    if (is_there(entry.path() / file))
      check_machine(entry.path() / file, *platform, findings);
    else
      findings.error(fmt::format("binaries/{} contains no {}", name, file), "name the library after modelIdentifier");
  }
  check_own_binary(library_path(identifier, folder), findings);
}

void check_machine(const fs::path& library, const modeldesc::Platform& expected, Findings findings) {
  if (modeldesc::is_built_for(expected, library)) return;
  const auto folder = library.parent_path().filename().string();
  const auto found = modeldesc::find_platforms(library);
  const auto text =
      fmt::format("binaries/{}/{} is {}, but {} means {}", folder, library.filename().string(),
                  found.empty() ? "no library of a known platform" : fmt::format("for {}", found.front()->text), folder,
                  expected.text);
  // FMI 2.0 has a single folder for macOS, which is older than Macs with ARM processors. Some tools use it for both
  // processors.
  const bool is_only_mac = !found.empty() && found.front()->format == modeldesc::BinaryFormat::mach_o &&
                           expected.format == modeldesc::BinaryFormat::mach_o;
  if (is_only_mac)
    findings.warning(text, "add a library for the platform of the folder, or make it universal with lipo");
  else
    findings.error(text, "put it into the folder of its platform");
}

bool is_own_binary(const fs::path& library) {
  return is_there(library) && modeldesc::is_built_for(modeldesc::this_platform(), library);
}

void check_own_binary(const fs::path& library, Findings findings) {
  if (is_there(library)) return;
  findings.warning(fmt::format("there is no binary for {} (binaries/{}/{})", modeldesc::this_platform().text,
                               library.parent_path().filename().string(), library.filename().string()),
                   "build one; without it, mebots check tests the behaviour only in part or not at all");
}

void check_symbols(const ModelDescription& model, FmuKind kind, const fs::path& library, Findings findings) {
  const auto names = exported_names(library);
  const auto& flags = *master::implementation_of(model, kind);
  std::vector<std::string> missing;
  std::vector<std::string> spared;
  fmi2::for_each_function([&](const char* name, auto, fmi2::Need need) {
    if (!is_of_other_kind(need, kind) && !names.contains(name))
      (is_wanted(need, flags) ? missing : spared).emplace_back(name);
  });
  if (!missing.empty())
    findings.error(
        fmt::format("{} lacks {}", library.filename().string(), fmt::join(missing, ", ")),
        "export them with default visibility and C linkage; a function that the FMU does not offer returns fmi2Error");
  if (!spared.empty())
    findings.at(Level::pedantic)
        .warning(fmt::format(
                     "{} lacks {}; its description does not offer them, but some tools refuse a library without them",
                     library.filename().string(), fmt::join(spared, ", ")),
                 "export them too, and return fmi2Error");
}

void check_other_symbols(const fs::path& library, Findings findings) {
  std::set<std::string> known;
  fmi2::for_each_function([&](const char* name, auto, fmi2::Need) { known.insert(name); });
  const auto names = exported_names(library);
  std::vector<std::string> extra;
  for (const auto& name : names) {
    const bool is_expected = known.contains(name) || name.starts_with("fmi2") || name == master::kKeepsNoState;
    if (!is_expected && !is_linkers_own(name)) extra.push_back(name);
  }
  if (extra.empty()) return;
  constexpr std::size_t kShown = 5;
  const auto count = extra.size();
  if (count > kShown) extra.resize(kShown);
  findings.at(Level::pedantic)
      .warning(fmt::format("{} exports {} more names, such as {}: they can collide with another FMU's",
                           library.filename().string(), count, fmt::join(extra, ", ")),
               "hide them: -fvisibility=hidden, or a linker version script that keeps fmi2*");
}

bool can_be_run(const ModelDescription& model, FmuKind kind, const fs::path& library) {
  const auto names = exported_names(library);
  const auto& flags = *master::implementation_of(model, kind);
  bool all = kind == FmuKind::model_exchange || names.contains("fmi2Reset");
  fmi2::for_each_function([&](const char* name, auto, fmi2::Need need) {
    const bool called = need != fmi2::Need::always && need != fmi2::Need::co_simulation &&
                        need != fmi2::Need::directional_derivative && !is_of_other_kind(need, kind);
    if (called && is_wanted(need, flags) && !names.contains(name)) all = false;
  });
  return all;
}

void check_needed_libraries(const fs::path& library, Findings findings) {
  NeededLibraries(library.parent_path(), findings).follow(library, {});
}

}  // namespace mebots::check
