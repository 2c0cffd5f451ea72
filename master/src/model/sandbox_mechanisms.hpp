// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace mebots::master {

/// The names of the mechanisms of a sandbox in a config.
inline constexpr const char* kNamespaces = "namespaces";  ///< Linux namespaces and a private file tree (bubblewrap)
inline constexpr const char* kLandlock = "landlock";      ///< restricts the access to files, and signals
inline constexpr const char* kSeccomp = "seccomp";        ///< restricts system calls
inline constexpr std::array kMechanisms = {kNamespaces, kLandlock, kSeccomp};

}  // namespace mebots::master
