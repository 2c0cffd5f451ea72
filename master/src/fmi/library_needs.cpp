// SPDX-License-Identifier: Apache-2.0
#include "fmi/library_state.hpp"

#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

namespace mebots::master {
namespace {

namespace fs = std::filesystem;
using modeldesc::ElfSymbol;
using modeldesc::LoadedLibrary;

/// The folders that ld.so(8) searches last. The folders of /etc/ld.so.conf.d are not included: a library in one of them
/// is identified only by its name.
constexpr const char* kSystemFolders[] = {"/lib/x86_64-linux-gnu",
                                          "/usr/lib/x86_64-linux-gnu",
                                          "/lib/aarch64-linux-gnu",
                                          "/usr/lib/aarch64-linux-gnu",
                                          "/usr/local/lib",
                                          "/lib64",
                                          "/usr/lib64",
                                          "/lib",
                                          "/usr/lib"};

struct InterpreterKind {
  std::string_view text;
  std::string_view library;               // start of the library's name
  std::vector<std::string_view> symbols;  // starts of symbol names
};

const std::vector<InterpreterKind>& interpreters() {
  static const std::vector<InterpreterKind> all = {
      {"a Python interpreter", "libpython", {"Py_", "_Py_", "PyObject_", "PyImport_", "PyGILState_", "PyRun_"}},
      {"a Java virtual machine", "libjvm.so", {"JNI_CreateJavaVM", "JNI_GetCreatedJavaVMs"}},
      {"an R interpreter", "libR.so", {"Rf_initEmbeddedR"}},
      {"a Julia runtime", "libjulia", {"jl_init", "julia_init"}},
      {"a MATLAB runtime", "libmwmclmcrrt", {"mclInitializeApplication"}},
  };
  return all;
}

bool is_inside(const fs::path& file, const fs::path& folder) {
  const auto inner = fs::weakly_canonical(file);
  const auto outer = fs::weakly_canonical(folder);
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  std::string bytes(stream ? static_cast<std::size_t>(stream.tellg()) : 0, '\0');
  stream.seekg(0);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

bool is_elf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  char magic[4] = {};
  return stream.read(magic, sizeof magic) && std::string_view(magic, sizeof magic) ==
                                                 "\x7f"
                                                 "ELF";
}

std::vector<std::string> environment_folders() {
  const char* path = std::getenv("LD_LIBRARY_PATH");
  std::vector<std::string> folders;
  std::string_view rest = path == nullptr ? "" : path;
  while (!rest.empty()) {
    const auto end = std::min(rest.find_first_of(":;"), rest.size());
    if (end > 0) folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return folders;
}

/// Finds needed libraries like ld.so(8), except that libraries of the FMU take precedence over loaded libraries.
/// Callers must check whether this exception changes the result.
class NeedsReader {
 public:
  NeedsReader(const fs::path& folder, const std::vector<LoadedLibrary>& loaded)
      : folder_(&folder), loaded_(&loaded), environment_(environment_folders()) {}

  LibraryNeeds read(const fs::path& file) {
    follow_file(file, {});
    if (imports("dlopen") || imports("dlmopen")) {
      needs_.loads_libraries = true;
      follow_all_files();
    }
    find_interpreter();
    return std::move(needs_);
  }

 private:
  void follow_file(const fs::path& file, std::vector<std::string> inherited) {
    if (!files_.insert(fs::weakly_canonical(file)).second) return;
    auto elf = modeldesc::read_elf_library(file);
    const auto runpath = modeldesc::search_folders(elf.runpath, file);
    const auto rpath = modeldesc::search_folders(elf.rpath, file);
    if (elf.runpath.empty()) inherited.insert(inherited.begin(), rpath.begin(), rpath.end());
    auto folders = elf.runpath.empty() ? inherited : std::vector<std::string>{};
    folders.insert(folders.end(), environment_.begin(), environment_.end());
    folders.insert(folders.end(), runpath.begin(), runpath.end());
    const auto needed = elf.needed;
    needs_.libraries.push_back({file, std::move(elf)});
    for (const auto& name : needed) follow_name(name, folders, inherited);
  }

  void follow_name(const std::string& name, const std::vector<std::string>& folders,
                   const std::vector<std::string>& inherited) {
    if (!needs_.names.insert(name).second) return;
    const auto found = first_with(name, folders);
    if (found && is_inside(*found, *folder_)) {
      needs_.brought.emplace(name, *found);
      follow_file(*found, inherited);
      return;
    }
    const auto loaded =
        std::ranges::find_if(*loaded_, [&](const LoadedLibrary& library) { return has_name(library, name); });
    if (loaded != loaded_->end()) {
      needs_.shared.insert(loaded->file);
      for (const auto& next : loaded->needed) follow_name(next, {}, {});
      return;
    }
    if (is_c_library(name)) return;
    const std::vector<std::string> system(std::begin(kSystemFolders), std::end(kSystemFolders));
    try {
      if (const auto file = found ? found : first_with(name, system)) follow_file(*file, inherited);
    } catch (const Error&) {  // the file is for another machine: the loader continues with the next folder
      return;
    }
  }

  /// Adds all libraries of the FMU, because the FMU may load any of them later.
  void follow_all_files() {
    std::error_code ignored;
    for (const auto& entry : fs::recursive_directory_iterator(*folder_, ignored)) {
      if (!entry.is_regular_file(ignored) || !is_elf(entry.path())) continue;
      try {
        const auto known = needs_.libraries.size();
        follow_file(entry.path(), {});
        if (needs_.libraries.size() == known) continue;
        const auto soname = needs_.libraries[known].elf.soname;
        needs_.brought.emplace(entry.path().filename().string(), entry.path());
        if (!soname.empty()) needs_.brought.emplace(soname, entry.path());
      } catch (const Error&) {  // the file is for another machine, or is a program
        continue;
      }
    }
  }

  static std::optional<fs::path> first_with(const std::string& name, const std::vector<std::string>& folders) {
    for (const auto& folder : folders) {
      if (auto file = fs::path(folder) / name; is_there(file)) return file;
    }
    return std::nullopt;
  }

  bool imports(std::string_view name) const {
    return any_own_symbol([&](const ElfSymbol& symbol) { return !symbol.defined && symbol.name == name; });
  }

  /// True if the predicate is true for a symbol in the FMU's own files.
  template <typename Predicate>
  bool any_own_symbol(Predicate is_it) const {
    return std::ranges::any_of(needs_.libraries, [&](const NewLibrary& library) {
      return is_inside(library.file, *folder_) && std::ranges::any_of(library.elf.symbols, is_it);
    });
  }

  void find_interpreter() {
    std::vector<std::string_view> texts;
    std::ranges::transform(interpreters(), std::back_inserter(texts), &InterpreterKind::library);
    const auto opened = needs_.loads_libraries ? needs_.mentioned(texts) : std::set<std::string_view>{};
    for (const auto& interpreter : interpreters()) {
      const auto starts = [&](const ElfSymbol& symbol) {
        return std::ranges::any_of(interpreter.symbols,
                                   [&](std::string_view start) { return symbol.name.starts_with(start); });
      };
      const bool needed = std::ranges::any_of(
          needs_.names, [&](const std::string& name) { return name.starts_with(interpreter.library); });
      if (!needed && !any_own_symbol(starts) && !opened.contains(interpreter.library)) continue;
      needs_.interpreter = interpreter.text;
      return;
    }
  }

  const fs::path* folder_;
  const std::vector<LoadedLibrary>* loaded_;
  std::vector<std::string> environment_;
  std::set<fs::path> files_;
  LibraryNeeds needs_;
};

}  // namespace

std::set<std::string_view> LibraryNeeds::mentioned(const std::vector<std::string_view>& texts) const {
  std::set<fs::path> files;
  if (!libraries.empty()) files.insert(libraries.front().file);
  for (const auto& [name, file] : brought) files.insert(file);
  std::set<std::string_view> found;
  for (const auto& file : files) {
    const auto bytes = bytes_of(file);
    for (const auto text : texts) {
      if (bytes.find(text) != std::string::npos) found.insert(text);
    }
  }
  return found;
}

bool has_name(const LoadedLibrary& library, const std::string& name) {
  return library.soname == name || library.file.filename().native() == name;
}

bool is_c_library(std::string_view name) {
  constexpr std::string_view kParts[] = {"libc.so.",  "libm.so.",    "libdl.so.", "libpthread.so.",
                                         "librt.so.", "libutil.so.", "ld-linux",  "libresolv.so."};
  return std::ranges::any_of(kParts, [&](std::string_view part) { return name.starts_with(part); });
}

LibraryNeeds read_library_needs(const fs::path& file, const fs::path& folder,
                                const std::vector<LoadedLibrary>& loaded) {
  return NeedsReader(folder, loaded).read(file);
}

}  // namespace mebots::master
