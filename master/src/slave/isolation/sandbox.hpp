// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// The sandbox of a host process. It consists of mechanisms, each of which a system may refuse: see kMechanisms.
namespace mebots::master::isolation {

/// What a sandboxed FMU may use.
struct Sandbox {
  std::filesystem::path folder;    ///< the unpacked FMU: read-only
  std::vector<std::string> reads;  ///< further files and folders that it may read
};

/// A mechanism that the system refuses.
struct Refusal {
  std::string mechanism;  ///< one of kMechanisms
  std::string reason;
};

/// Replaces this process by bubblewrap, which starts `program` with `arguments` again: with its own user, process,
/// network, IPC and UTS namespaces, without capabilities, in a tree of files that holds only system libraries,
/// `sandbox` and an empty /tmp. Open descriptors stay open. Returns only if that is impossible.
Refusal enter_namespaces(const Sandbox& sandbox, const std::string& program, const std::vector<std::string>& arguments);

/// Restricts the calling process further: environment, limits, files by Landlock. `has_namespaces`: it was started by
/// enter_namespaces(). Otherwise, the process writes only to a new folder in `sandbox.folder`. Returns the mechanisms
/// that the system refuses. One thread only.
std::vector<Refusal> restrict_process(const Sandbox& sandbox, bool has_namespaces);

}  // namespace mebots::master::isolation
