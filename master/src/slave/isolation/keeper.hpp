// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

namespace mebots::master::isolation {

/// Forks, and returns in the child, which leads a session of its own. The calling process stays as its keeper. When the
/// child ends, when `parent` does (by whatever signal), or when end_kept() asks for it, the keeper ends every process
/// that came of the child, whatever group or session it went to. Then it ends itself as the child ended. The child ends
/// with its keeper, too; neither dumps core. One thread only. Throws Error when there is no process to be had.
void fork_kept(pid_t parent);

/// Asks a keeper to end what it keeps and itself, and waits for that without taking its status.
void end_kept(pid_t keeper);

}  // namespace mebots::master::isolation
