// SPDX-License-Identifier: Apache-2.0
#include "fmi/fmu.hpp"

#include "base/own_threads.hpp"
#include "fmi/call/library_call.hpp"
#include "fmi/process/process_state.hpp"
#include "fmi/windows/wine.hpp"
#include "fmi/windows_library.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "mebots/modeldesc/platform.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <thread>
#include <vector>

namespace mebots::master {
namespace {

/// Returns the relative paths of all files in binaries/ of an unpacked FMU.
std::vector<std::string> binaries(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "binaries", ignored)) {
    if (!entry.is_directory(ignored)) names.push_back(entry.path().lexically_relative(folder / "binaries").string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Returns advice for a library that cannot be loaded.
std::string way_out(std::string_view why, const std::filesystem::path& folder) {
  if (why.find("undefined symbol: Py") != std::string_view::npos ||
      why.find("undefined symbol: _Py") != std::string_view::npos) {
    return "The FMU expects the library of a Python interpreter, and none was found: install libpython3-dev, or set "
           "MEBOTS_PYTHON to a Python that has a shared library";
  }
  return fmt::format("Install the missing library, or put it into binaries/{} of the FMU", folder.filename().string());
}

/// Returns advice for an FMU with binaries only for Windows. `library` is the library for 64-bit Windows.
std::string windows_way_out(const std::filesystem::path& folder, const std::filesystem::path& library) {
  const auto* const other = is_folder(folder / "sources")
                                ? "The FMU contains its sources: compile them (FMPy: `fmpy compile`)"
                                : "Request a binary for Linux from the FMU's author or tool";
  if (!is_there(library))
    return fmt::format(". mebots runs binaries for 64-bit Windows ({}) only, under wine. {}",
                       library.lexically_relative(folder).string(), other);
  return fmt::format(". {}, or: {}", windows::find_wine().missing, other);
}

/// True if a library of the folder is still loaded, because dlclose() does not unload every library. The loader would
/// use it for the next FMU with the same path.
bool has_loaded_from(const std::filesystem::path& folder) {
  const auto start = folder.string() + "/";
  return std::ranges::any_of(modeldesc::loaded_libraries(modeldesc::UniqueSymbols::skip),
                             [&](const auto& library) { return library.file.native().starts_with(start); });
}

/// Throws InputError for the missing library `file`. `folder` contains the unpacked FMU.
[[noreturn]] void fail_without_binary(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                      const std::filesystem::path& file, const std::filesystem::path& for_windows) {
  auto found = binaries(folder);
  const bool has_windows = std::ranges::any_of(found, [](const std::string& name) { return name.ends_with(".dll"); });
  constexpr std::size_t kShown = 10;
  const auto count = found.size();
  if (count > kShown) found.resize(kShown);
  const auto listed = found.empty() ? "is nothing"
                                    : fmt::format("{} {}{}", count == 1 ? "is" : "are", fmt::join(found, ", "),
                                                  count > kShown ? fmt::format(" and {} more", count - kShown) : "");
  throw InputError(
      ErrorCode::fmu_unsupported,
      fmt::format("{}: this FMU has no binary for {} ({}, named after its modelIdentifier); in binaries/ there {}{}",
                  archive.string(), modeldesc::this_platform().text, file.lexically_relative(folder).string(), listed,
                  has_windows ? windows_way_out(folder, for_windows) : ""));
}

}  // namespace

Fmu::Fmu(std::filesystem::path archive, std::filesystem::path folder, std::optional<FmuKind> wish)
    : archive_(std::move(archive)),
      wish_(wish),
      folder_(std::move(folder)),
      description_(modeldesc::read_xml(folder_ / "modelDescription.xml")) {}

Fmu::~Fmu() {
  try {
    unload();
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch): a run has unloaded it before, and reported it
  }
}

void Fmu::unload() {
  if (windows_library_) {
    // After a fatal status, the library must not be called, not even to unload it. Its process ends together with this
    // process.
    if (corrupted_) static_cast<void>(windows_library_.release());
    windows_library_.reset();
    functions_ = {};
    return;
  }
  auto* const library = std::exchange(library_, nullptr);
  // After a fatal status, no code of the FMU may be called. The library stays loaded, because unloading runs its
  // destructors.
  if (library == nullptr || corrupted_ || kept_loaded_ || threads_left() != 0) return;
  const auto handlers = handlers_in_libraries();
  call_library(archive_, "unloaded", [&] { dlclose(library); });
  reset_unloaded_handlers(handlers);
  functions_ = {};
  at_load_.reset();
  if (own_folder_ && !has_loaded_from(folder_)) own_folder_->release_path();
}

std::size_t Fmu::threads_left() const {
  const auto now = foreign_threads();
  return static_cast<std::size_t>(
      std::ranges::count_if(now, [&](pid_t thread) { return !threads_of_others_.contains(thread); }));
}

std::shared_ptr<const modeldesc::ModelDescription> Fmu::model(const modeldesc::StructuralValues& values) {
  const auto is_array = [](const modeldesc::Variable& variable) { return !variable.fmi3->dimensions.empty(); };
  if (std::ranges::none_of(description_.variables, is_array)) return {std::shared_ptr<void>(), &description_};
  const std::lock_guard lock(models_mutex_);
  auto& kept = models_[values];
  auto model = kept.lock();
  if (!model) {
    try {
      model = std::make_shared<const modeldesc::ModelDescription>(modeldesc::with_elements(description_, values));
    } catch (const Error& error) {
      throw InputError(error.code(), fmt::format("{}: {}", archive_.string(), error.what()));
    }
    kept = model;
  }
  return model;
}

void Fmu::require_library() {
  if (is_loaded()) return;
  // The C++ library of an FMU records in its memory that the process has started a thread. Starting a thread here
  // ensures that this happens before later runs.
  static const bool has_had_threads = [] {
    std::thread([] {}).join();
    return true;
  }();
  static_cast<void>(has_had_threads);
  {
    const OwnLoad own;
    load();
  }
  at_load_.emplace(folder_);
}

FmuKind Fmu::kind() const {
  const auto usual = description_.co_simulation ? FmuKind::co_simulation : FmuKind::model_exchange;
  const auto kind = wish_.value_or(usual);
  if (description_.is_fmi1() && kind == FmuKind::model_exchange) {
    throw InputError(
        ErrorCode::fmu_unsupported,
        fmt::format("{}: this FMU is for model exchange of FMI 1.0, which mebots does not support; export it "
                    "for co-simulation, or for model exchange of FMI 2.0 or 3.0",
                    archive_.string()));
  }
  if (implementation_of(description_, kind) != nullptr) return kind;
  if (!description_.co_simulation && !description_.model_exchange) {
    throw InputError(
        ErrorCode::fmu_unsupported,
        fmt::format("{}: this FMU is for scheduled execution only, which mebots does not support; export it "
                    "for co-simulation",
                    archive_.string()));
  }
  throw InputError(ErrorCode::fmu_unsupported,
                   fmt::format("{}: this FMU does not offer <{}>. Leave out \"kind\", or set it to \"{}\"",
                               archive_.string(), element_of(kind), word_of(usual)));
}

const LibraryImports& Fmu::imports() {
  if (at_load_) return at_load_->imports();
  if (!imports_) imports_ = read_imports(libraries_of(folder_));
  return *imports_;
}

std::optional<std::string> Fmu::uncleanliness() {
  auto reason = imports().reason();
  return reason || !at_load_ ? reason : at_load_->owned_memory();
}

std::optional<std::string> Fmu::difference() const {
  {
    const std::lock_guard lock(elsewhere_mutex_);
    if (!difference_elsewhere_.empty()) return difference_elsewhere_;
  }
  if (!at_load_ || !used()) return std::nullopt;
  if (corrupted_) return "it returned a fatal status";
  if (at_load_->owned_memory()) return at_load_->owned_memory();
  return at_load_->difference();
}

std::optional<std::string> Fmu::state_elsewhere() {
  if (auto reason = uncleanliness()) return reason;
  return at_load_ ? at_load_->difference_while_used() : difference();
}

void Fmu::set_difference_elsewhere(std::string text) {
  const std::lock_guard lock(elsewhere_mutex_);
  difference_elsewhere_ = std::move(text);
}

void Fmu::load() {
  const auto file = library_file();
  if (runs_under_wine()) return load_under_wine();
  if (!is_there(file)) fail_without_binary(archive_, folder_, file, windows_library_file());
  files_of_others_ = open_files();
  threads_of_others_ = foreign_threads();
  const ProcessState before(files_of_others_);
  // A library that was built with -ffast-math changes the floating-point environment of the thread that loads it.
  const auto floats = FloatEnvironment::now();
  library_ = call_library(archive_, "loaded", [&] { return dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL); });
  if (const auto found = FloatEnvironment::now(); found != floats) {
    floats_at_load_ = found;
    floats.enter();
  }
  changes_at_load_ = before.put_right();
  if (library_ == nullptr) {
    const std::string why = dlerror();
    throw InputError(ErrorCode::fmu_inconsistent,
                     fmt::format("{}: the FMU's shared library cannot be loaded: {}. {}", archive_.string(), why,
                                 way_out(why, file.parent_path())));
  }
  functions_ = load_functions(library_, {archive_, description_, kind()});
}

std::filesystem::path Fmu::library_file() const {
  const auto name = implementation_of(description_, kind())->model_identifier + ".so";
  return modeldesc::binaries_folder(folder_, description_.is_fmi3(), name) / name;
}

std::filesystem::path Fmu::windows_library_file() const {
  const auto windows = std::ranges::find_if(modeldesc::platforms(), [](const modeldesc::Platform& platform) {
    return platform.fmi3_folder == "x86_64-windows";
  });
  const auto& name = implementation_of(description_, kind())->model_identifier;
  return folder_ / "binaries" / windows->folder(description_.is_fmi3()) / (name + std::string(windows->suffix));
}

bool Fmu::is_for_windows_alone() const {
  return !is_there(library_file()) && is_there(windows_library_file());
}

bool Fmu::runs_under_wine() const {
  return is_for_windows_alone() && windows::find_wine();
}

void Fmu::load_under_wine() {
  const auto settings = folder_.parent_path() / fmt::format("wine-{}", getpid());
  const LibraryOwner owner{archive_, description_, kind()};
  windows_library_ = std::make_unique<windows::WindowsLibrary>(owner, windows_library_file(), settings);
  functions_ = windows_library_->functions();
  check_functions(functions_, owner);
  files_of_others_ = open_files();
  threads_of_others_ = foreign_threads();
}

std::string Fmu::resource_path() const {
  const auto folder = folder_ / "resources";
  return is_there(folder) ? (folder / "").string() : std::string();
}

std::string Fmu::resource_uri() const {
  return file_uri(folder_ / "resources");
}

std::string Fmu::location_uri() const {
  return file_uri(folder_);
}

std::string file_uri(const std::filesystem::path& path) {
  std::string uri = "file://";
  for (const char c : std::filesystem::absolute(path).string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::strchr("/-._~", c) != nullptr;
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

}  // namespace mebots::master
