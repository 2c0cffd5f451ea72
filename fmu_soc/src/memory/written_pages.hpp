// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mebots::soc {

inline constexpr std::size_t kPageSize = 4096;

/// Returns which pages of this process, from that of `first` to that of `last`, have ever been written. If the system
/// refuses the information, all count as written.
std::vector<bool> written_pages(const std::uint8_t* first, const std::uint8_t* last);

}  // namespace mebots::soc
