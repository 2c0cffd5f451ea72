// SPDX-License-Identifier: Apache-2.0
// The section `threads`: "auto" or a number.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {

void read_threads(const Node& node, SystemDescription& system) {
  constexpr std::int64_t kMost = 256;
  if (node.is(data::Kind::text)) {
    system.threads = data::word_of<unsigned>({{"auto", kAutomaticThreads}})(node);
  } else {
    system.threads = static_cast<unsigned>(node.whole_number(1, kMost));
  }
}

}  // namespace mebots::master::config
