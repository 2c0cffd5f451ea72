// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::master {

/// From now on a signal that ends the process inside an FMU (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) is told on
/// standard error first, with instance, call and time. Then it takes its course. A signal that somebody handles already
/// stays theirs. From any thread; once is enough.
void install_crash_notice();

}  // namespace mebots::master
