// SPDX-License-Identifier: Apache-2.0
#include "memory/written_pages.hpp"

#include <unistd.h>

#include <fstream>

namespace mebots::soc {

// Source: Linux, Documentation/admin-guide/mm/pagemap.rst.
std::vector<bool> written_pages(const std::uint8_t* first, const std::uint8_t* last) {
  const auto page = reinterpret_cast<std::uintptr_t>(first) / kPageSize;
  const auto count = reinterpret_cast<std::uintptr_t>(last) / kPageSize - page + 1;
  std::vector<bool> written(count, true);
  std::vector<std::uint64_t> entries(count);
  const auto bytes = static_cast<std::streamsize>(count * sizeof entries[0]);
  std::ifstream map("/proc/self/pagemap", std::ios::binary);
  map.seekg(static_cast<std::streamoff>(page * sizeof entries[0]));
  if (::sysconf(_SC_PAGESIZE) != long{kPageSize} || !map.read(reinterpret_cast<char*>(entries.data()), bytes))
    return written;
  for (std::size_t i = 0; i < count; ++i) written[i] = entries[i] >> 62 != 0;  // the page is in memory or swapped out
  return written;
}

}  // namespace mebots::soc
