// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace mebots::master {

/// Mechanisms of a sandbox, by the names that a config uses.
inline constexpr const char* kNamespaces = "namespaces";  ///< by bubblewrap, with a private tree of files
inline constexpr const char* kLandlock = "landlock";      ///< files, once more; signals
inline constexpr const char* kSeccomp = "seccomp";        ///< system calls
inline constexpr std::array kMechanisms = {kNamespaces, kLandlock, kSeccomp};

}  // namespace mebots::master
