// SPDX-License-Identifier: Apache-2.0
#include "memory/memory.hpp"

#include "memory/written_pages.hpp"

#include "mebots/assert.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <vector>

namespace mebots::soc {
namespace {

/// Minimum size of a region that is searched, saved and restored page by page, so that pages that were never accessed
/// take no time.
constexpr std::size_t kLargeSize = std::size_t{8} << 20;
/// Calls `visit` with the start and the size of pieces that together contain all bytes other than 0. A large array has
/// one piece per page.
template <typename Visit>
void for_pieces(const std::uint8_t* bytes, std::size_t size, Visit visit) {
  if (size < kLargeSize) {
    visit(std::size_t{0}, size);
    return;
  }
  const auto offset = reinterpret_cast<std::uintptr_t>(bytes) % kPageSize;
  const auto written = written_pages(bytes, bytes + (size - 1));
  for (std::size_t first = 0; first < size; first += kPageSize) {
    const auto count = std::min(kPageSize, size - first);
    if (written[(offset + first) / kPageSize] || written[(offset + first + count - 1) / kPageSize]) visit(first, count);
  }
}

/// Calls `visit` with every word of the region that has one of the marks. Tests eight words at a time, because marks
/// are rare.
template <typename Visit>
void for_marked(const Region& region, std::uint8_t marks, Visit visit) {
  const auto pattern = 0x0101'0101'0101'0101ULL * marks;
  for_pieces(region.marks.get(), region.size / 4, [&](std::size_t begin, std::size_t count) {
    for (auto first = begin; first < begin + count; first += 8) {
      const auto words = std::min(begin + count - first, std::size_t{8});
      std::uint64_t several = 0;
      std::memcpy(&several, region.marks.get() + first, words);
      if ((several & pattern) == 0) continue;
      for (auto word = first; word < first + words; ++word) {
        if ((region.marks[word] & marks) != 0) visit(static_cast<std::uint32_t>(word));
      }
    }
  });
}

/// Saves or restores a large region: the numbers of the pages that contain bytes other than 0, and the bytes of these
/// pages.
void visit_pages(Region& region, state::Visitor& v) {
  std::vector<std::uint32_t> pages;
  std::vector<std::uint8_t> bytes;
  const auto is_empty = [&](std::size_t first, std::size_t count) {
    const auto* begin = region.data.get() + first;
    return *begin == 0 && std::memcmp(begin, begin + 1, count - 1) == 0;
  };
  if (!v.restores()) {
    for_pieces(region.data.get(), region.size, [&](std::size_t first, std::size_t count) {
      if (is_empty(first, count)) return;
      pages.push_back(static_cast<std::uint32_t>(first / kPageSize));
      bytes.insert(bytes.end(), region.data.get() + first, region.data.get() + first + count);
    });
  }
  v(region.name + ".pages", pages);
  v(region.name, bytes);
  if (!v.restores()) return;
  for_pieces(region.data.get(), region.size, [&](std::size_t first, std::size_t count) {
    if (!is_empty(first, count)) std::memset(region.data.get() + first, 0, count);
  });
  std::size_t at = 0;
  for (const auto page : pages) {
    const auto first = std::size_t{page} * kPageSize;
    const auto count = first < region.size ? std::min(kPageSize, region.size - first) : 0;
    if (count == 0 || bytes.size() - at < count) {
      throw Error(ErrorCode::state_damaged,
                  fmt::format("a saved state is damaged: page {} of memory {}", page, region.name));
    }
    std::memcpy(region.data.get() + first, bytes.data() + at, count);
    at += count;
  }
}

/// Allocates bytes that are 0. With calloc(), the system allocates the pages of a large block at the first write.
ZeroedBytes zeroed(std::size_t size) {
  auto* bytes = static_cast<std::uint8_t*>(std::calloc(size, 1));
  if (bytes == nullptr) throw std::bad_alloc();
  return ZeroedBytes(bytes);
}

}  // namespace

Region& Memory::add(const std::string& name, std::uint32_t base, std::uint32_t size) {
  if (size == 0 || size % 4 != 0 || base % 4 != 0) {
    throw Error(
        fmt::format("memory {}: base 0x{:08x} and size {} must be multiples of 4, the size above 0", name, base, size));
  }
  if (std::uint64_t{base} + size > 0x1'0000'0000ULL) {
    throw Error(
        fmt::format("memory {}: 0x{:08x} + {} bytes passes the end of the 32-bit address space", name, base, size));
  }
  for (const auto& other : regions_) {
    if (base < std::uint64_t{other.base} + other.size && other.base < std::uint64_t{base} + size) {
      throw Error(
          fmt::format("memory {} at 0x{:08x} overlaps memory {} at 0x{:08x}", name, base, other.name, other.base));
    }
  }
  Region region;
  region.name = name;
  region.base = base;
  region.size = size;
  region.data = zeroed(size);
  region.marks = zeroed(size / 4);
  return regions_.emplace_back(std::move(region));
}

Region* Memory::find(std::uint32_t address, std::uint32_t count) {
  for (auto& region : regions_) {
    if (region.holds(address, count)) return &region;
  }
  return nullptr;
}

const Region* Memory::find(std::uint32_t address, std::uint32_t count) const {
  for (const auto& region : regions_) {
    if (region.holds(address, count)) return &region;
  }
  return nullptr;
}

bool Memory::covers(std::uint32_t address, std::uint32_t count) const {
  for (std::uint64_t at = address; at < std::uint64_t{address} + count;) {
    const auto* region = at > 0xffffffffU ? nullptr : find(static_cast<std::uint32_t>(at), 1);
    if (region == nullptr) return false;
    at = std::uint64_t{region->base} + region->size;
  }
  return true;
}

bool Memory::read(std::uint32_t address, std::span<std::uint8_t> bytes) const {
  if (bytes.size() > 0xffffffffU) return false;
  const auto* region = find(address, static_cast<std::uint32_t>(bytes.size()));
  if (region == nullptr) return false;
  if (!bytes.empty()) std::memcpy(bytes.data(), region->data.get() + (address - region->base), bytes.size());
  return true;
}

bool Memory::write(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  if (bytes.size() > 0xffffffffU) return false;
  auto* region = find(address, static_cast<std::uint32_t>(bytes.size()));
  if (region == nullptr) return false;
  if (!bytes.empty()) std::memcpy(region->data.get() + (address - region->base), bytes.data(), bytes.size());
  return true;
}

void Memory::mark(std::uint32_t address, std::uint32_t count, std::uint8_t marks) {
  auto* region = find(address, count);
  if (region == nullptr || count == 0) return;
  const auto first = (address - region->base) / 4;
  const auto last = (address - region->base + count - 1) / 4;
  for (auto word = first; word <= last; ++word) region->marks[word] |= marks;
  MEBOTS_ASSERT(first <= last && last < region->size / 4, "every word has a mark");
}

bool Memory::marked(std::uint32_t address, std::uint32_t count, std::uint8_t marks) const {
  const auto* region = find(address, count);
  if (region == nullptr || count == 0) return false;
  const auto first = (address - region->base) / 4;
  const auto last = (address - region->base + count - 1) / 4;
  for (auto word = first; word <= last; ++word) {
    if ((region->marks[word] & marks) != 0) return true;
  }
  return false;
}

void Memory::unmark(std::uint32_t address, std::uint32_t count, std::uint8_t marks) {
  auto* region = find(address, count);
  if (region == nullptr || count == 0) return;
  const auto first = (address - region->base) / 4;
  const auto last = (address - region->base + count - 1) / 4;
  for (auto word = first; word <= last; ++word) region->marks[word] &= static_cast<std::uint8_t>(~marks);
}

std::uint8_t Memory::add_code_mark() {
  static constexpr std::array<std::uint8_t, 6> kMarks{Region::kCode, 8, 16, 32, 64, 128};
  if (code_marks_ == kMarks.size()) throw Error("a memory has at most 6 decode caches");
  return kMarks[code_marks_++];
}

bool Memory::changed(std::uint32_t address, std::uint32_t count) {
  if (!marked(address, count, Region::kAnyCode)) return false;
  invalidate_code(address, count);
  return true;
}

void Memory::invalidate_code(std::uint32_t address, std::uint32_t count) {
  changes_[code_generation_ % kKeptChanges] = {address, count};
  ++code_generation_;
  if (code_generation_ - oldest_change_ > kKeptChanges) ++oldest_change_;
}

void Memory::forget_code() {
  ++code_generation_;
  oldest_change_ = code_generation_;
}

void Memory::visit(state::Visitor& v) {
  std::vector<std::uint32_t> loop_ends;  // words of the region that end hardware loops
  for (auto& region : regions_) {
    loop_ends.clear();
    for_marked(region, Region::kLoop, [&](std::uint32_t word) { loop_ends.push_back(word); });
    if (region.size < kLargeSize) {
      v(region.name, std::span(region.data.get(), region.size));
    } else {
      visit_pages(region, v);
    }
    v(region.name + ".loop_ends", loop_ends);
    if (!v.restores()) continue;
    for_marked(region, Region::kLoop, [&](std::uint32_t word) { region.marks[word] ^= Region::kLoop; });
    for (const auto word : loop_ends) {
      if (word >= region.size / 4)
        throw Error(ErrorCode::state_damaged, fmt::format("a saved state has a loop outside memory {}", region.name));
      region.marks[word] |= Region::kLoop;
    }
  }
  if (v.restores()) forget_code();  // in the restored state, blocks may end at other addresses
}

}  // namespace mebots::soc
