// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <set>

namespace mebots::master {

/// While this object exists, marks the calling thread as a thread of mebots. Other threads of the process belong to
/// FMUs or to the embedding program.
class OwnThread {
 public:
  OwnThread();
  ~OwnThread();
  OwnThread(const OwnThread&) = delete;
  OwnThread& operator=(const OwnThread&) = delete;
};

/// Marks the calling thread, and all threads that it will create, as threads of mebots. Used before calls of a library
/// that creates threads. These threads must not call FMUs.
void mark_own_family();

/// Must be called before a call to an FMU. If the process is a fork, marks its present threads as threads of mebots,
/// because they belong to the program.
void adopt_threads_of_fork();

/// Returns the kernel's numbers of those threads of this process that are not marked as threads of mebots.
std::set<pid_t> foreign_threads();

}  // namespace mebots::master
