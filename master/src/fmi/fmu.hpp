// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/call/foreign_call.hpp"
#include "fmi/fmu_functions.hpp"
#include "fmi/library_state.hpp"
#include "fmi/process/process_state.hpp"
#include "fmi/unpack_folder.hpp"
#include "mebots/modeldesc/array_elements.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "model/fmu_kind.hpp"

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

namespace windows {
class WindowsLibrary;
}

/// An FMU that is unpacked into a temporary folder. The constructor reads the description. The shared library is loaded
/// on its first use. The destructor deletes the folder. It also unloads the library, unless a thread may still execute
/// the library's code.
class Fmu {
 public:
  /// Opens and unpacks an archive. `wish` is the requested kind of the FMU's instances. If `wish` is empty, the kind is
  /// co-simulation if the FMU offers it, otherwise model exchange. Throws InputError if the file is not an FMU of
  /// version 1.0, 2.0 or 3.0.
  explicit Fmu(std::filesystem::path archive, std::optional<FmuKind> wish = {});
  /// Opens an FMU that another process has unpacked into `folder`. The other process must delete the folder.
  Fmu(std::filesystem::path archive, std::filesystem::path folder, std::optional<FmuKind> wish = {});
  ~Fmu();
  Fmu(const Fmu&) = delete;
  Fmu& operator=(const Fmu&) = delete;

  const std::filesystem::path& archive() const { return archive_; }
  /// Returns the folder with the unpacked FMU.
  const std::filesystem::path& folder() const { return folder_; }
  const modeldesc::ModelDescription& description() const { return description_; }
  /// Returns notices about the archive that the user should see.
  const std::vector<std::string>& notices() const { return notices_; }
  /// Returns the description for these values of structural parameters. In it, each array of FMI 3.0 is replaced by its
  /// elements. Calls with the same values return the same object while it is in use. The result must not outlive the
  /// FMU.
  std::shared_ptr<const modeldesc::ModelDescription> model(const modeldesc::StructuralValues& values = {});
  /// Loads the shared library, unless it is already loaded. Throws InputError that names the missing library or
  /// function if loading fails.
  void require_library();
  /// Returns the functions of the FMU's library; loads it if necessary. `Functions` must be the function table for the
  /// FMU's version of FMI. Throws the same errors as require_library().
  template <typename Functions>
  const Functions& functions() {
    require_library();
    return std::get<Functions>(functions_);
  }
  /// Returns the kind of the FMU's instances. Throws InputError if the FMU does not offer the requested kind.
  FmuKind kind() const;
  /// Returns the path of the shared library for this platform, even if it does not exist.
  std::filesystem::path library_file() const;
  /// True if the FMU has a library for 64-bit Windows and none for this platform.
  bool is_for_windows_alone() const;
  /// True if the FMU is only for Windows and wine can run it. Such a library is loaded in a separate process.
  bool runs_under_wine() const;
  bool is_loaded() const { return library_ != nullptr || windows_library_ != nullptr; }
  /// Returns the `link_map` of the loaded shared library. Returns null if the library is not loaded.
  const void* library() const { return library_; }
  /// Unloads the shared library, which the destructor would do otherwise. No instance may exist. Throws InputError if
  /// the library throws an exception.
  void unload();
  /// Keeps the shared library loaded until the process ends.
  void keep_loaded() { kept_loaded_ = true; }
  /// True after an instance returned the status fatal. Afterwards, no instance of this FMU may be called.
  bool corrupted() const { return corrupted_; }
  void set_corrupted() { corrupted_ = true; }
  /// Returns the changes that loading the library caused in this process, as ProcessState describes them. The second
  /// and later calls return an empty list.
  std::vector<std::string> take_changes_at_load() { return std::exchange(changes_at_load_, {}); }
  /// Returns the descriptors that were open before the FMU's library was loaded. The FMU must not close these
  /// descriptors, but may close all others.
  const OpenFiles& files_of_others() const { return files_of_others_; }
  /// Counts a new instance. Returns true for the first few instances, whose calls are checked for changes of the
  /// process. Calls to other instances are not checked individually, because a check takes as long as a thousand small
  /// calls. May be called from any thread.
  bool enter() {
    ++instances_;
    return watched_++ < kMostWatched;
  }
  /// Counts a freed instance. If it was the last one, returns the number of running threads that were started since the
  /// library was loaded. Otherwise returns 0. May be called from any thread.
  std::size_t leave() { return --instances_ == 0 ? threads_left() : 0; }
  /// Returns the imported functions that change the process. Reads them from the files of the libraries.
  const LibraryImports& imports();
  /// Returns why the FMU is not clean, if its libraries show a reason before the first instance. Returns nullopt if no
  /// reason is visible.
  std::optional<std::string> uncleanliness();
  /// True if an instance was created in this process at any time.
  bool used() const { return watched_ != 0; }
  /// Returns a description of how the memory of the libraries differs from its content directly after loading. Returns
  /// nullopt if it does not differ. No instance may exist.
  std::optional<std::string> difference() const;
  /// Returns why the FMU computes with data outside of its instances' states. Returns nullopt if it does not.
  std::optional<std::string> state_elsewhere();
  /// Stores the result that difference() or state_elsewhere() had in the process in which the FMU runs.
  void set_difference_elsewhere(std::string text);

  /// Returns the floating-point environment that the library set while it was loaded. Returns nullopt if the library
  /// changed nothing. After loading, the environment of the thread was restored.
  const std::optional<FloatEnvironment>& floats_at_load() const { return floats_at_load_; }
  /// Returns true on the first call only. The caller that receives true must report this FMU's floating-point
  /// environment. May be called from any thread.
  bool claim_float_report() { return !floats_reported_.exchange(true); }
  /// Returns the folder of the FMU's resources as a `file:///` URI, for fmi2Instantiate.
  std::string resource_uri() const;
  /// Returns the folder with the unpacked FMU as a `file:///` URI, for fmiInstantiateSlave (FMI 1.0).
  std::string location_uri() const;
  /// Returns the path of the FMU's resources folder with a separator at its end, for fmi3Instantiate... Returns an
  /// empty text if there is no such folder.
  std::string resource_path() const;

 private:
  static constexpr int kMostWatched = 32;

  void load();
  void load_under_wine();
  std::filesystem::path windows_library_file() const;
  std::size_t threads_left() const;

  std::filesystem::path archive_;
  std::optional<FmuKind> wish_;
  std::unique_ptr<UnpackFolder> own_folder_;  // null if another process unpacked the FMU
  std::filesystem::path folder_;
  // Declared before the description, because reading the description appends notices.
  std::vector<std::string> notices_;
  modeldesc::ModelDescription description_;
  void* library_ = nullptr;
  bool kept_loaded_ = false;
  bool corrupted_ = false;
  std::vector<std::string> changes_at_load_;
  OpenFiles files_of_others_;
  std::set<pid_t> threads_of_others_;
  std::atomic<int> instances_{0};
  std::atomic<int> watched_{0};  // number of instances so far, including freed ones
  std::optional<FloatEnvironment> floats_at_load_;
  std::optional<LibraryState> at_load_;    // state of the loaded libraries
  std::optional<LibraryImports> imports_;  // imports of libraries that are not loaded
  mutable std::mutex elsewhere_mutex_;
  std::string difference_elsewhere_;
  std::atomic<bool> floats_reported_{false};
  FmuFunctions functions_;  // empty if the library is not loaded
  std::mutex models_mutex_;
  std::map<modeldesc::StructuralValues, std::weak_ptr<const modeldesc::ModelDescription>> models_;
  std::unique_ptr<windows::WindowsLibrary> windows_library_;  // used in place of library_ for an FMU that wine runs
};

/// Opens each archive once, for all of its instances and for consecutive runs.
class FmuLibrary {
 public:
  /// Returns the FMU with the content that the file had when it was first opened, even if the file has changed. After a
  /// fatal status, opens the archive again. An archive is a separate FMU for each kind of simulation, because
  /// co-simulation and model exchange may have different libraries.
  std::shared_ptr<Fmu> open(const std::filesystem::path& archive, std::optional<FmuKind> wish = {});
  /// Drops the FMUs that were used and are not clean. The next call of open() for such an FMU unpacks and loads it
  /// again.
  void forget_changed();

 private:
  std::map<std::pair<std::filesystem::path, std::optional<FmuKind>>, std::shared_ptr<Fmu>> fmus_;
};

/// Returns the path as a `file:///` URI. Special characters are percent-encoded.
std::string file_uri(const std::filesystem::path& path);

}  // namespace mebots::master
