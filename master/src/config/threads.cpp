// SPDX-License-Identifier: Apache-2.0
// The section `threads`: "auto" or a number.
#include "sections.hpp"

namespace mebots::master::config {

void read_threads(const JsonNode& node, SystemDescription& system) {
  constexpr std::int64_t kMost = 256;
  const auto& value = node.value();
  if (value.is_string() && value.get<std::string>() == "auto") {
    system.threads = kAutomaticThreads;
    return;
  }
  if (!value.is_number_integer() || value.get<std::int64_t>() < 1 || value.get<std::int64_t>() > kMost)
    node.fail("\"auto\" or a number of threads from 1 to 256 is expected");
  system.threads = value.get<unsigned>();
}

}  // namespace mebots::master::config
