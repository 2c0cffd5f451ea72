// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/efuse.hpp"

#include "devices/core/kinds.hpp"

#include <fmt/format.h>

#include <optional>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kCommand = 0x000;
constexpr std::uint32_t kTimings = 0x004;
constexpr std::uint32_t kRegisters = 0x200;
constexpr std::uint32_t kBits = 8;

/// Which fuse register is there, if any.
std::optional<std::uint32_t> fuse_at(std::uint32_t offset) {
  const auto index = (offset - kRegisters) / 4;
  if (offset < kRegisters || index >= Efuse::kFuses) return std::nullopt;
  return index;
}

}  // namespace

bool Efuse::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  if (offset == kTimings) {
    value = timings_;
    return true;
  }
  const auto fuse = fuse_at(offset);
  if (!fuse) return false;
  if (command_ != kRead) {
    host_.complain(fmt::format("{}: a fuse is read while the command is not read (1 into offset 0): 0", entry_.name));
    value = 0;
    return true;
  }
  value = fuses_[*fuse];
  return true;
}

bool Efuse::store(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t value) {
  if (offset == kTimings) {
    timings_ = value;
    return true;
  }
  if (offset == kCommand) {
    if (value == kRead || value == kProgram || value == kSleep) {
      command_ = value;
    } else {
      host_.complain(fmt::format("{}: there is no command {}: read is {}, program {}, sleep {}; nothing was changed",
                                 entry_.name, value, kRead, kProgram, kSleep));
    }
    return true;
  }
  const auto fuse = fuse_at(offset);
  if (!fuse) return false;
  if (command_ != kProgram) {
    host_.complain(fmt::format(
        "{}: a fuse is stored into while the command is not program ({} into offset 0): nothing was changed",
        entry_.name, kProgram));
  } else if (value >= kBits) {
    host_.complain(
        fmt::format("{}: bit {} of fuse register {} was to be programmed, which has bits 0 to 7: nothing was "
                    "changed",
                    entry_.name, value, *fuse));
  } else {
    fuses_[*fuse] = static_cast<std::uint8_t>(fuses_[*fuse] | 1U << value);
  }
  return true;
}

/// The low bytes of a fuse register; the others take words.
bool Efuse::load_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t& value, unsigned /*size*/) {
  return fuse_at(offset) && offset % 4 == 0 && load(offset, now, value);
}

bool Efuse::store_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t value, unsigned size) {
  const auto mask = size == 1 ? 0xffU : 0xffffU;
  return fuse_at(offset) && offset % 4 == 0 && store(offset, now, value & mask);
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_efuse, {}, make_of_entry<gap8_devices::Efuse>)
