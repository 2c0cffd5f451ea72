// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mebots::soc {

inline constexpr std::size_t kPageSize = 4096;

/// Returns a flag for each page of this process from the page of `first` to the page of `last`: true if the page was
/// ever written. All flags are true if the operating system does not provide this information.
std::vector<bool> written_pages(const std::uint8_t* first, const std::uint8_t* last);

}  // namespace mebots::soc
