// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/process_state.hpp"
#include "message/message_hub.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

struct ResolvedSystem;

/// Watches the process while several FMUs are called: reports process-wide changes and reverts them. A report names an
/// FMU only if no other FMU runs in this process. InstanceCalls reports changes earlier, after each call that it
/// watches.
class ProcessWatch {
 public:
  /// Watches process-wide state that the FMUs of this process can change, judged by the functions that their libraries
  /// import. `system` and `messages` must outlive the watch.
  ProcessWatch(const ResolvedSystem& system, MessageSink& messages);

  /// Compares the process with its previous state, and reports changes. The message continues with `during` after
  /// "changed the whole process".
  void look(const std::string& during, std::int64_t time_ns);
  /// True if the calling thread's signal mask changed. Costs one system call.
  bool is_mask_changed() const { return before_ && before_->is_mask_changed(); }

 private:
  void begin();

  const ResolvedSystem* system_;
  MessageSink* messages_;
  ProcessReach reach_ = ProcessReach::nothing;
  std::optional<ProcessState> before_;
};

}  // namespace mebots::master
