// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/fmu_functions.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace mebots::master::windows {

class Process;

/// An FMU's library for Windows in the process mebots-windows-host.exe under wine. functions() forward their calls to
/// that process. If that process ends, this process ends in the same way: by the same signal after a structured
/// exception, otherwise with the same exit code. The master then reports the same as for a library for Linux. A process
/// can have only one such library.
class WindowsLibrary {
 public:
  /// Starts wine with settings in the new folder `settings`, and loads the library. Throws InputError if the library
  /// cannot be loaded.
  WindowsLibrary(const LibraryOwner& owner, const std::filesystem::path& library,
                 const std::filesystem::path& settings);
  /// Unloads the library and waits for the end of its process.
  ~WindowsLibrary();
  WindowsLibrary(const WindowsLibrary&) = delete;
  WindowsLibrary& operator=(const WindowsLibrary&) = delete;

  /// Returns the exported functions of the library. Other functions are null.
  FmuFunctions functions() const { return functions_; }

 private:
  std::unique_ptr<Process> process_;
  FmuFunctions functions_;
};

}  // namespace mebots::master::windows
