// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/process_state.hpp"
#include "message/message_hub.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace mebots::master {

struct ResolvedSystem;

/// Watches the process while several FMUs are called: reports what one of them changed for all code in it, and puts it
/// back. It names one FMU only if no other runs in this process. A slave that is watched alone (Fmi2Slave) reports its
/// own changes earlier.
class ProcessWatch {
 public:
  /// Watches what the FMUs of this process can change, as their imports show. `system` and `messages` must outlive the
  /// watch.
  ProcessWatch(const ResolvedSystem& system, MessageSink& messages);

  /// Compares the process with the one before; `during` completes "changed the process for all, ...".
  void look(const std::string& during, std::int64_t time_ns);
  /// Returns true if the calling thread blocks other signals. Costs one system call.
  bool is_mask_changed() const { return before_ && before_->is_mask_changed(); }

 private:
  void begin();

  const ResolvedSystem* system_;
  MessageSink* messages_;
  ProcessReach reach_ = ProcessReach::nothing;
  std::optional<ProcessState> before_;
};

}  // namespace mebots::master
