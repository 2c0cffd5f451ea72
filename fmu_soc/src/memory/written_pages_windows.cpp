// SPDX-License-Identifier: Apache-2.0
#include "memory/written_pages.hpp"

namespace mebots::soc {

// Windows lists written pages only for memory that was allocated with a write watch, so all pages count as written.
// Saving a large memory then takes longer.
std::vector<bool> written_pages(const std::uint8_t* first, const std::uint8_t* last) {
  const auto page = reinterpret_cast<std::uintptr_t>(first) / kPageSize;
  return std::vector<bool>(reinterpret_cast<std::uintptr_t>(last) / kPageSize - page + 1, true);
}

}  // namespace mebots::soc
