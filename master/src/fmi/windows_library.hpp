// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/fmu_functions.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace mebots::master::windows {

class Process;

/// An FMU's library for Windows, which runs in the process mebots-windows-host.exe under wine. Each of its functions()
/// forwards its call to this process. If that process ends, this process ends in the same way: by the corresponding
/// signal after a structured exception, otherwise with the same exit code. Therefore the master reports the same as for
/// an FMU for Linux. A process can have at most one such library.
class WindowsLibrary {
 public:
  /// Starts wine, creates its settings in the new folder `settings`, and loads the library. Throws InputError if the
  /// library cannot be loaded.
  WindowsLibrary(const LibraryOwner& owner, const std::filesystem::path& library,
                 const std::filesystem::path& settings);
  /// Unloads the library and waits until its process has ended.
  ~WindowsLibrary();
  WindowsLibrary(const WindowsLibrary&) = delete;
  WindowsLibrary& operator=(const WindowsLibrary&) = delete;

  /// Returns the functions that the library exports. Functions that it does not export are null.
  FmuFunctions functions() const { return functions_; }

 private:
  std::unique_ptr<Process> process_;
  FmuFunctions functions_;
};

}  // namespace mebots::master::windows
