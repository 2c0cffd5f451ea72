// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/process_state.hpp"
#include "message/message_hub.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

struct ResolvedSystem;

/// Detects process-wide changes while several FMUs are called. Reports and reverts the changes. The report names the
/// FMU only if no other FMU runs in this process. Some calls are also checked by InstanceCalls, which reports changes
/// earlier.
class ProcessWatch {
 public:
  /// Stores the process-wide state that the FMUs in this process can change. Their imported functions determine this
  /// part of the state. Both arguments must outlive this object.
  ProcessWatch(const ResolvedSystem& system, MessageSink& messages);

  /// Compares the state of the process with the stored state. Reports and reverts changes. The message contains
  /// `during` after the words "changed the whole process".
  void look(const std::string& during, std::int64_t time_ns);
  /// True if the signal mask of the calling thread has changed. Needs one system call.
  bool is_mask_changed() const { return before_ && before_->is_mask_changed(); }

 private:
  void begin();

  const ResolvedSystem* system_;
  MessageSink* messages_;
  ProcessReach reach_ = ProcessReach::nothing;
  std::optional<ProcessState> before_;
};

}  // namespace mebots::master
