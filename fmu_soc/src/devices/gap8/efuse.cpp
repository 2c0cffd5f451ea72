// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"
#include "mebots/soc/device_kind.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <optional>

namespace mebots::soc::gap8_devices {
namespace {

/// Models GAP8's fuses: 128 registers of eight bits, which are 0 at the start. A programmed bit stays 1. A command
/// selects one of the modes read, program and sleep. In program mode, a store into a register programs one of its bits,
/// without delay. Source: archi/efuse/efuse_v1.h, hal/efuse/efuse_v1.h.
class Efuse final : public Device {
 public:
  static constexpr std::size_t kFuses = 128;

  Efuse(const BoardDevice& entry, DeviceHost& host) : entry_(entry), host_(host) {}

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  bool load_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t& value, unsigned size) override;
  bool store_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t value, unsigned size) override;
  void visit(state::Visitor& v) override {
    v("command", command_);
    v("timings", timings_);
    v("fuses", fuses_);
  }

 private:
  static constexpr std::uint32_t kRead = 1;
  static constexpr std::uint32_t kProgram = 2;
  static constexpr std::uint32_t kSleep = 4;

  const BoardDevice& entry_;
  DeviceHost& host_;
  std::uint32_t command_ = kSleep;
  std::uint32_t timings_ = 0;
  std::array<std::uint8_t, kFuses> fuses_{};
};

constexpr std::uint32_t kCommand = 0x000;
constexpr std::uint32_t kTimings = 0x004;
constexpr std::uint32_t kRegisters = 0x200;
constexpr std::uint32_t kBits = 8;

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
    host_.complain(
        fmt::format("{}: a fuse was read without the command read (1 at offset 0): the value is 0", entry_.name));
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
    host_.complain(
        fmt::format("{}: a fuse was written without the command program ({} at offset 0): nothing was changed",
                    entry_.name, kProgram));
  } else if (value >= kBits) {
    host_.complain(
        fmt::format("{}: the program tried to set bit {} of fuse register {}, which has bits 0 to 7: nothing was "
                    "changed",
                    entry_.name, value, *fuse));
  } else {
    fuses_[*fuse] = static_cast<std::uint8_t>(fuses_[*fuse] | 1U << value);
  }
  return true;
}

/// Loads the low bytes of a fuse register. All other registers allow only word accesses.
bool Efuse::load_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t& value, unsigned /*size*/) {
  return fuse_at(offset) && offset % 4 == 0 && load(offset, now, value);
}

bool Efuse::store_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t value, unsigned size) {
  const auto mask = size == 1 ? 0xffU : 0xffffU;
  return fuse_at(offset) && offset % 4 == 0 && store(offset, now, value & mask);
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_efuse, {}, make_of_entry<gap8_devices::Efuse>)
