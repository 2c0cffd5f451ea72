// SPDX-License-Identifier: Apache-2.0
// Checks whether FMUs can share this process. The loader identifies libraries by name, keeps one copy of a unique
// symbol (STB_GNU_UNIQUE), and searches symbols in the program and its libraries first. FMUs in one process can
// therefore use code and variables of each other. Namespaces of the loader (dlmopen) do not help: there are only 16,
// each with its own C library.
#include "fmi/library_state.hpp"

#include "fmi/fmu.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"

#include <cxxabi.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace mebots::master {
namespace {

namespace fs = std::filesystem;
using modeldesc::ElfSymbol;
using modeldesc::LoadedLibrary;

using Reason = std::optional<Admission>;

Reason certain(std::string reason) {
  return Admission{false, true, std::move(reason)};
}
Reason possible(std::string reason) {
  return Admission{false, false, std::move(reason)};
}

/// An FMU whose library this process has loaded.
struct Resident {
  std::weak_ptr<Fmu> fmu;
  std::string archive;
  LibraryNeeds needs;
};

std::string readable(const std::string& symbol) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> name(abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status),
                                                         &std::free);
  return name ? std::string(name.get()) : symbol;
}

/// True if two definitions of a unique symbol (STB_GNU_UNIQUE) conflict. The loader uses only the first definition in
/// the whole process. This is harmless only if both are constants with equal bytes.
bool collide(const ElfSymbol& one, const ElfSymbol& other) {
  return one.name == other.name && (one.constant.empty() || one.constant != other.constant);
}

std::vector<ElfSymbol> unique_symbols(const LibraryNeeds& needs) {
  std::vector<ElfSymbol> symbols;
  for (const auto& library : needs.libraries) {
    std::ranges::copy_if(library.elf.symbols, std::back_inserter(symbols), &ElfSymbol::unique);
  }
  return symbols;
}

/// Returns the names of symbols that the libraries define and use. The loader may use a definition in another library
/// instead. Excludes unique symbols, which are compared separately.
std::set<std::string> preemptible_names(const LibraryNeeds& needs) {
  std::set<std::string> bound;
  for (const auto& library : needs.libraries) {
    for (const auto& symbol : library.elf.symbols) {
      if (symbol.bound && !library.elf.symbolic) bound.insert(symbol.name);
    }
  }
  std::set<std::string> names;
  for (const auto& library : needs.libraries) {
    for (const auto& symbol : library.elf.symbols) {
      // The C++ library compares types by name. A second definition of a type is harmless.
      const bool type = symbol.name.starts_with("_ZTI") || symbol.name.starts_with("_ZTS");
      if (symbol.preemptible && !symbol.unique && !type && bound.contains(symbol.name)) names.insert(symbol.name);
    }
  }
  return names;
}

/// Finds conflicts between an FMU and the libraries of this process.
class ProcessComparison {
 public:
  ProcessComparison(const LibraryNeeds& needs, const std::vector<LoadedLibrary>& loaded,
                    const std::vector<Resident>& residents, const std::map<fs::path, std::string>& archives)
      : needs_(&needs), loaded_(&loaded), residents_(&residents), archives_(&archives) {}

  Reason reason() const {
    if (auto found = interpreter()) return found;
    if (auto found = loaded_names()) return found;
    if (auto found = resident_names()) return found;
    if (auto found = loaded_unique_symbols()) return found;
    if (auto found = resident_unique_symbols()) return found;
    if (auto found = global_symbols()) return found;
    return later_libraries();
  }

 private:
  Reason interpreter() const {
    if (needs_->interpreter.empty()) return std::nullopt;
    return possible(
        fmt::format("it embeds {}, and a process can have only one such interpreter and cannot unload it safely",
                    needs_->interpreter));
  }

  Reason loaded_names() const {
    for (const auto& library : *loaded_) {
      if (library.file.empty()) continue;
      for (const auto& name : {library.soname, library.file.filename().string()}) {
        if (name.empty() || is_c_library(name)) continue;
        const auto* const owner = archive_of(library.file);
        if (needs_->brought.contains(name)) {
          return certain(owner == nullptr ? fmt::format("its archive contains {}, and this process has loaded {}", name,
                                                        library.file.string())
                                          : other_library(name, *owner));
        }
        if (owner != nullptr && needs_->names.contains(name)) return certain(library_of_system(name, *owner));
      }
    }
    return std::nullopt;
  }

  /// Finds conflicts of library names, also with libraries that another FMU may load later.
  Reason resident_names() const {
    for (const auto& resident : *residents_) {
      const auto mentioned_here = mentioned(*needs_, resident.needs.brought);
      const auto mentioned_there = mentioned(resident.needs, needs_->brought);
      for (const auto& [name, file] : resident.needs.brought) {
        if (is_c_library(name)) continue;
        if (needs_->brought.contains(name)) return certain(other_library(name, resident.archive));
        if (needs_->names.contains(name)) return certain(library_of_system(name, resident.archive));
        if (mentioned_here.contains(name))
          return certain(
              fmt::format("it uses {}, and the archive of {} contains a library of that name", name, resident.archive));
      }
      for (const auto& [name, file] : needs_->brought) {
        if (is_c_library(name)) continue;
        if (resident.needs.names.contains(name) || mentioned_there.contains(name))
          return certain(
              fmt::format("its archive contains {}, and {} uses a library of that name", name, resident.archive));
      }
    }
    return std::nullopt;
  }

  /// Returns the names in `brought` that the FMU `other` may open while it runs.
  static std::set<std::string_view> mentioned(const LibraryNeeds& other,
                                              const std::map<std::string, fs::path>& brought) {
    if (!other.loads_libraries || brought.empty()) return {};
    std::vector<std::string_view> names;
    for (const auto& [name, file] : brought) names.push_back(name);
    return other.mentioned(names);
  }

  Reason loaded_unique_symbols() const {
    const auto own = unique_symbols(*needs_);
    if (own.empty()) return std::nullopt;
    for (const auto& library : modeldesc::loaded_libraries(modeldesc::UniqueSymbols::read)) {
      if (needs_->shared.contains(library.file)) continue;
      const auto* const owner = archive_of(library.file);
      if (auto found = unique_symbol(own, library.unique, owner == nullptr ? shown(library.file) : *owner))
        return found;
    }
    return std::nullopt;
  }

  Reason resident_unique_symbols() const {
    const auto own = unique_symbols(*needs_);
    for (const auto& resident : *residents_) {
      if (auto found = unique_symbol(own, unique_symbols(resident.needs), resident.archive)) return found;
    }
    return std::nullopt;
  }

  static Reason unique_symbol(const std::vector<ElfSymbol>& own, const std::vector<ElfSymbol>& others,
                              const std::string& owner) {
    std::map<std::string_view, const ElfSymbol*> by_name;
    for (const auto& other : others) by_name.emplace(other.name, &other);
    for (const auto& symbol : own) {
      const auto found = by_name.find(symbol.name);
      if (found == by_name.end() || !collide(symbol, *found->second)) continue;
      return certain(
          fmt::format("it and {} both define {}, and a process can have only one such symbol (STB_GNU_UNIQUE)", owner,
                      readable(symbol.name)));
    }
    return std::nullopt;
  }

  /// Finds conflicts of symbols. The loader searches the program, its libraries, and libraries opened with RTLD_GLOBAL
  /// before the libraries of the FMU.
  Reason global_symbols() const {
    void* const program = dlopen(nullptr, RTLD_LAZY);
    if (program == nullptr) return std::nullopt;
    Reason found;
    for (const auto& name : preemptible_names(*needs_)) {
      const void* const place = dlsym(program, name.c_str());
      if (place == nullptr) continue;
      Dl_info info{};
      const fs::path file = dladdr(place, &info) != 0 && info.dli_fname != nullptr ? info.dli_fname : "";
      if (needs_->shared.contains(file) || is_c_library(file.filename().native())) continue;
      const auto* const owner = archive_of(file);
      found = certain(fmt::format("its calls of {} would reach {}, whose symbols are global", readable(name),
                                  owner == nullptr ? shown(file) : *owner));
      break;
    }
    dlclose(program);
    return found;
  }

  Reason later_libraries() const {
    if (!needs_->loads_libraries) return std::nullopt;
    for (const auto& resident : *residents_) {
      if (!resident.needs.loads_libraries || (needs_->brought.empty() && resident.needs.brought.empty())) continue;
      return possible(
          fmt::format("both it and {} load libraries of their own while they run (dlopen), and those of one "
                      "can reach the other",
                      resident.archive));
    }
    return std::nullopt;
  }

  static std::string other_library(const std::string& name, const std::string& archive) {
    return fmt::format("its archive contains {}, and {} has another library of that name", name, archive);
  }
  static std::string library_of_system(const std::string& name, const std::string& archive) {
    return fmt::format("it needs {}, and the archive of {} contains another library of that name", name, archive);
  }
  static std::string shown(const fs::path& file) { return file.empty() ? "the program itself" : file.string(); }

  const std::string* archive_of(const fs::path& file) const {
    for (auto folder = file.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
      if (const auto found = archives_->find(folder); found != archives_->end()) return &found->second;
    }
    return nullptr;
  }

  const LibraryNeeds* needs_;
  const std::vector<LoadedLibrary>* loaded_;
  const std::vector<Resident>* residents_;
  const std::map<fs::path, std::string>* archives_;
};

/// The FMUs in this process, and the folders of closed FMUs, whose libraries may still be loaded.
struct Residents {
  std::mutex mutex;
  std::vector<Resident> all;
  std::map<fs::path, std::string> archives;  // key: folder of an unpacked FMU; value: its archive

  static Residents& of_this_process() {
    static Residents residents;
    return residents;
  }

  void forget_unloaded() {
    std::erase_if(all, [](const Resident& resident) {
      const auto fmu = resident.fmu.lock();
      return !fmu || !fmu->is_loaded();
    });
  }

  void add(const std::shared_ptr<Fmu>& fmu, LibraryNeeds needs) {
    for (auto& library : needs.libraries) std::erase_if(library.elf.symbols, std::not_fn(&ElfSymbol::unique));
    archives[fmu->folder()] = fmu->archive().filename().string();
    all.push_back({fmu, fmu->archive().filename().string(), std::move(needs)});
  }
};

}  // namespace

Admission load_into_this_process(const std::shared_ptr<Fmu>& fmu, Risk risk) {
  auto& residents = Residents::of_this_process();
  const std::lock_guard lock(residents.mutex);
  Admission loaded{true, false, {}};
  if (fmu->is_loaded()) return loaded;
  if (fmu->runs_under_wine()) return *certain("it has a binary for Windows, which runs under wine, and none for Linux");
  residents.forget_unloaded();
  LibraryNeeds needs;
  const auto present = modeldesc::loaded_libraries(modeldesc::UniqueSymbols::skip);
  try {
    needs = read_library_needs(fmu->library_file(), fmu->folder(), present);
  } catch (const Error&) {
    fmu->require_library();  // throws the error of the loader
    return loaded;
  }
  auto reason = ProcessComparison(needs, present, residents.all, residents.archives).reason();
  if (reason && (reason->certain || risk == Risk::refuse)) return *reason;
  if (!needs.interpreter.empty()) fmu->keep_loaded();
  fmu->require_library();
  residents.add(fmu, std::move(needs));
  if (!reason) return loaded;
  reason->loaded = true;
  return *reason;
}

}  // namespace mebots::master
