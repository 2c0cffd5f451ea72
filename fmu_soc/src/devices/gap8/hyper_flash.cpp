// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/hyper_flash.hpp"

#include "mebots/error.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace mebots::soc::gap8_devices {
namespace {

/// Byte addresses to which the words of a command are written.
constexpr std::uint32_t kFlashFirst = 0x555 << 1;
constexpr std::uint32_t kFlashSecond = 0x2AA << 1;

constexpr std::uint32_t kFlashFirstUnlock = 0xAA;
constexpr std::uint32_t kFlashSecondUnlock = 0x55;
constexpr std::uint32_t kFlashProgram = 0xA0;
constexpr std::uint32_t kFlashErase = 0x80;
constexpr std::uint32_t kFlashEraseAll = 0x10;
constexpr std::uint32_t kFlashEraseSector = 0x30;
constexpr std::uint32_t kFlashShowStatus = 0x70;
constexpr std::uint32_t kFlashReset = 0xF0;

constexpr std::uint8_t kFlashReady = 0x80;  // bit 7 of the status word
constexpr std::uint8_t kFlashErased = 0xff;

}  // namespace

void HyperFlash::set_image(std::span<const std::uint8_t> image) {
  image_ = image;
  changed_.clear();
  expects_ = Expects::unlock;
  shows_status_ = false;
}

bool HyperFlash::write(std::uint32_t place, std::span<const std::uint8_t> bytes) {
  if (expects_ == Expects::data) {
    expects_ = Expects::unlock;
    return program(place, bytes);
  }
  if (bytes.size() == 2) return obey(place, std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8);
  expects_ = Expects::unlock;
  return false;
}

bool HyperFlash::expect(bool good, Expects next) {
  expects_ = good ? next : Expects::unlock;
  return good;
}

bool HyperFlash::obey(std::uint32_t place, std::uint32_t word) {
  if (word == kFlashReset) return expect(true, Expects::unlock);
  const bool is_first = place == kFlashFirst && word == kFlashFirstUnlock;
  const bool is_second = place == kFlashSecond && word == kFlashSecondUnlock;
  switch (expects_) {
    case Expects::unlock:
      if (place == kFlashFirst && word == kFlashShowStatus) {
        shows_status_ = true;
        return true;
      }
      return expect(is_first, Expects::second_unlock);
    case Expects::second_unlock:
      return expect(is_second, Expects::command);
    case Expects::command:
      if (word == kFlashErase) return expect(place == kFlashFirst, Expects::erase_unlock);
      return expect(place == kFlashFirst && word == kFlashProgram, Expects::data);
    case Expects::erase_unlock:
      return expect(is_first, Expects::second_erase_unlock);
    case Expects::second_erase_unlock:
      return expect(is_second, Expects::erase);
    case Expects::erase:
      expects_ = Expects::unlock;
      if (word == kFlashEraseSector) return erase(place);
      return place == kFlashFirst && word == kFlashEraseAll && erase_all();
    case Expects::data:
      break;
  }
  return false;
}

bool HyperFlash::program(std::uint32_t place, std::span<const std::uint8_t> bytes) {
  if (bytes.empty() || place / kLineBytes != (place + bytes.size() - 1) / kLineBytes) return false;
  auto& sector = sector_at(place);
  const auto at = place - sector.place;
  for (std::size_t i = 0; i < bytes.size(); ++i) sector.bytes[at + i] &= bytes[i];
  return true;
}

bool HyperFlash::erase(std::uint32_t place) {
  std::ranges::fill(sector_at(place).bytes, kFlashErased);
  return true;
}

bool HyperFlash::erase_all() {
  for (std::uint32_t place = 0; place < kBytes; place += kSectorBytes) {
    if (place < image_.size()) erase(place);
  }
  for (auto& sector : changed_) std::ranges::fill(sector.bytes, kFlashErased);
  return true;
}

HyperFlash::Sector& HyperFlash::sector_at(std::uint32_t place) {
  const auto begin = place / kSectorBytes * kSectorBytes;
  const auto found = std::ranges::lower_bound(changed_, begin, {}, &Sector::place);
  if (found != changed_.end() && found->place == begin) return *found;
  Sector sector{begin, std::vector<std::uint8_t>(kSectorBytes)};
  read_image(begin, sector.bytes);
  return *changed_.insert(found, std::move(sector));
}

void HyperFlash::read_image(std::uint32_t place, std::span<std::uint8_t> bytes) const {
  const auto begin = std::min<std::size_t>(place, image_.size());
  const auto count = std::min(bytes.size(), image_.size() - begin);
  std::ranges::copy(image_.subspan(begin, count), bytes.begin());
  std::ranges::fill(bytes.subspan(count), kFlashErased);
}

void HyperFlash::read(std::uint32_t place, std::span<std::uint8_t> bytes) {
  if (shows_status_) {
    shows_status_ = false;
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = i % 2 == 0 ? kFlashReady : std::uint8_t{0};
    return;
  }
  read_image(place, bytes);
  for (const auto& sector : changed_) {
    const auto begin = std::max(place, sector.place);
    const auto end = std::min<std::uint64_t>(std::uint64_t{place} + bytes.size(), sector.place + kSectorBytes);
    if (begin >= end) continue;
    std::ranges::copy(std::span(sector.bytes).subspan(begin - sector.place, end - begin),
                      bytes.begin() + (begin - place));
  }
}

void HyperFlash::visit(state::Visitor& v) {
  v("expects", expects_);
  v("shows_status", shows_status_);
  v("changed", changed_);
  if (!v.restores()) return;
  for (const auto& sector : changed_) {
    if (sector.place >= kBytes || sector.place % kSectorBytes != 0 || sector.bytes.size() != kSectorBytes) {
      throw Error(ErrorCode::state_damaged, "a saved state is damaged: an invalid sector of the flash");
    }
  }
}

}  // namespace mebots::soc::gap8_devices
