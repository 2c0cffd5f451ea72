// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <set>

namespace mebots::master {

/// The thread that makes it is one of mebots' own, for as long as this lives. Other threads of the process belong to
/// FMUs or to the program around.
class OwnThread {
 public:
  OwnThread();
  ~OwnThread();
  OwnThread(const OwnThread&) = delete;
  OwnThread& operator=(const OwnThread&) = delete;
};

/// Calling thread, and all that it will start from now on, are mebots' own: for a library that has threads of its own.
/// No FMU may be called from there.
void mark_own_family();

/// Call it before an FMU is called: if the process is a fork, the threads that it has now are the program's own.
void adopt_threads_of_fork();

/// The threads of this process that are not mebots' own, by the kernel's number.
std::set<pid_t> foreign_threads();

}  // namespace mebots::master
