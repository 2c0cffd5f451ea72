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

/// Marks the calling thread, and all threads that it creates later, as threads of mebots. Call this before a library
/// creates threads. These threads must not call FMUs.
void mark_own_family();

/// Must be called before each call to an FMU. If the process was forked, marks its current threads as threads of
/// mebots, because they belong to the program.
void adopt_threads_of_fork();

/// Returns the kernel's numbers of those threads of this process that are not marked as threads of mebots.
std::set<pid_t> foreign_threads();

}  // namespace mebots::master
