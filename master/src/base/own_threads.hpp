// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <set>

namespace mebots::master {

/// Marks the calling thread as a thread of mebots during the lifetime of this object. All threads without a mark belong
/// to FMUs or to the embedding program.
class OwnThread {
 public:
  OwnThread();
  ~OwnThread();
  OwnThread(const OwnThread&) = delete;
  OwnThread& operator=(const OwnThread&) = delete;
};

/// Marks the calling thread, and all threads that it creates later, as threads of mebots. Must be called before a
/// library creates threads. These threads must not call FMUs.
void mark_own_family();

/// Must be called before each call to an FMU. After a fork, marks all threads of the child process as threads of
/// mebots.
void adopt_threads_of_fork();

/// Returns the kernel's ids of all threads of this process that are not marked.
std::set<pid_t> foreign_threads();

}  // namespace mebots::master
