// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace mebots::master {

/// The mechanisms of a sandbox, by their names in a config.
inline constexpr const char* kNamespaces = "namespaces";  ///< by bubblewrap, with a private file tree
inline constexpr const char* kLandlock = "landlock";      ///< files and signals
inline constexpr const char* kSeccomp = "seccomp";        ///< system calls
inline constexpr std::array kMechanisms = {kNamespaces, kLandlock, kSeccomp};

}  // namespace mebots::master
