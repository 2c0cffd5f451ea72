// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace mebots::master {

/// From now on a signal that ends the process inside an FMU is reported on standard error, with instance, call and
/// time, before it takes its course: SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS. A signal of a timer, or
/// one that the process sends itself, fails the runs that are busy (see end_by_signal()). A signal that somebody
/// handles already stays theirs, and so does SIGALRM while the program around has a timer. From any thread; once is
/// enough.
void install_crash_notice();

/// Returns true if the signal would end the process: its only handler is that of install_crash_notice().
bool ends_process(int signal);

/// "SIGALRM"; "signal 40" if it has no name.
std::string signal_name(int signal);

}  // namespace mebots::master
