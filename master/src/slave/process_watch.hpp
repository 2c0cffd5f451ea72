// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message.hpp"
#include "slave/process_state.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

struct ResolvedSystem;

/// Watches the process while many FMUs are called: tells what one of them changed for all, and puts it back. Which one
/// it was is known only where one FMU runs in this process; a slave that is watched by itself (FmuSlave) tells its own
/// changes before.
class ProcessWatch {
 public:
  /// Watches nothing where no instance runs in this process. `system` and `messages` must outlive the watch.
  ProcessWatch(const ResolvedSystem& system, MessageSink& messages);

  /// Looks now; `during` completes "changed the process for all, ...".
  void look(const std::string& during, std::int64_t time_ns);
  /// Returns true if the calling thread blocks other signals: a cheap question.
  bool is_mask_changed() const { return before_ && before_->is_mask_changed(); }

 private:
  const ResolvedSystem* system_;
  MessageSink* messages_;
  std::optional<ProcessState> before_;
};

}  // namespace mebots::master
