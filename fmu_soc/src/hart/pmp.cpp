// SPDX-License-Identifier: Apache-2.0
#include "hart/pmp.hpp"

#include "mebots/assert.hpp"

#include <bit>

namespace mebots::soc {
namespace {

constexpr std::uint8_t kRead = 1;
constexpr std::uint8_t kWrite = 2;
constexpr std::uint8_t kExecute = 4;
constexpr std::uint8_t kRights = kRead | kWrite | kExecute;
constexpr std::uint8_t kLocked = 0x80;
constexpr std::uint8_t kWritable = 0x9f;

enum class Match : std::uint8_t { off, top_of_range, word, power_of_two };

constexpr Match match_of(std::uint8_t configuration) {
  return static_cast<Match>(configuration >> 3 & 3U);
}

constexpr std::uint64_t kSpaceEnd = std::uint64_t{1} << 32;

}  // namespace

void Pmp::restart() {
  configurations_ = {};
  addresses_ = {};
  update_free();
}

std::uint32_t Pmp::configurations(unsigned index) const {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(configurations_[4 * index + i]) << (8 * i);
  return value;
}

void Pmp::set_configurations(unsigned index, std::uint32_t value) {
  MEBOTS_ASSERT(index < kMostEntries / 4);
  for (unsigned i = 0; i < 4; ++i) {
    const auto entry = 4 * index + i;
    if (entry >= entries_ || is_locked(entry)) continue;
    auto configuration = static_cast<std::uint8_t>(value >> (8 * i) & kWritable);
    // A configuration that allows writes but no reads is reserved.
    if ((configuration & kRead) == 0) configuration &= static_cast<std::uint8_t>(~kWrite);
    configurations_[entry] = configuration;
  }
  update_free();
}

/// Sets the address of an entry, unless the entry is locked. The address is also locked if the next entry is locked and
/// its range begins at this address (mode TOR).
void Pmp::set_address(unsigned entry, std::uint32_t value) {
  if (entry >= entries_ || is_locked(entry)) return;
  const bool begins_locked =
      entry + 1 < entries_ && is_locked(entry + 1) && match_of(configurations_[entry + 1]) == Match::top_of_range;
  if (!begins_locked) addresses_[entry] = value;
  update_free();
}

bool Pmp::is_locked(unsigned entry) const {
  return (configurations_[entry] & kLocked) != 0;
}

Pmp::Range Pmp::range_of(unsigned entry) const {
  const std::uint64_t address = addresses_[entry];
  switch (match_of(configurations_[entry])) {
    case Match::off:
      break;
    case Match::top_of_range: {
      const std::uint64_t first = entry == 0 ? 0 : std::uint64_t{addresses_[entry - 1]} << 2;
      return first < address << 2 ? Range{first, address << 2} : Range{};
    }
    case Match::word:
      return {address << 2, (address << 2) + 4};
    case Match::power_of_two: {
      const auto ones = static_cast<unsigned>(std::countr_one(addresses_[entry]));
      const auto size = std::uint64_t{8} << ones;
      return {(address << 2) & ~(size - 1), ((address << 2) & ~(size - 1)) + size};
    }
  }
  return {};
}

bool Pmp::allows(std::uint32_t address, unsigned size, Access access, Mode mode) const {
  const std::uint64_t first = address;
  const std::uint64_t end = first + size;
  for (unsigned entry = 0; entry < entries_; ++entry) {
    const auto range = range_of(entry);
    if (end <= range.first || first >= range.end) continue;
    if (first < range.first || end > range.end) return false;  // the entry covers only some of the bytes
    if (mode == Mode::machine && !is_locked(entry)) return true;
    return (configurations_[entry] & static_cast<std::uint8_t>(access)) != 0;
  }
  return mode == Mode::machine || entries_ == 0;
}

bool Pmp::is_free(Mode mode) const {
  for (unsigned entry = 0; entry < entries_; ++entry) {
    const auto range = range_of(entry);
    if (range.first == range.end) continue;
    const bool restricts = (mode == Mode::user || is_locked(entry)) && (configurations_[entry] & kRights) != kRights;
    const bool covers_all = range.first == 0 && range.end >= kSpaceEnd;
    if (restricts) return false;
    if (covers_all) return true;
  }
  return mode == Mode::machine || entries_ == 0;
}

void Pmp::update_free() {
  machine_is_free_ = is_free(Mode::machine);
  user_is_free_ = is_free(Mode::user);
}

void Pmp::visit(state::Visitor& v) {
  v("pmpcfg", configurations_);
  v("pmpaddr", addresses_);
  if (v.restores()) update_free();
}

}  // namespace mebots::soc
