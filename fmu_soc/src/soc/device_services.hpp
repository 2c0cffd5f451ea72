// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/soc.hpp"

#include "mebots/assert.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// What the chip does for its devices.
class Soc::Host final : public ChipHost, private PictureRoll {
 public:
  explicit Host(Soc& soc) : soc_(soc) {}

  bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const override {
    return soc_.memory_.read(address, bytes);
  }
  bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) override {
    return soc_.poke(address, bytes);
  }
  bool is_memory(std::uint32_t address, std::uint32_t size) const override {
    return soc_.memory_.find(address, size) != nullptr;
  }
  void print(std::string_view line) override {
    if (soc_.listeners_.console) soc_.listeners_.console(line);
  }
  void complain(std::string_view text) override {
    if (soc_.listeners_.faults) soc_.listeners_.faults(text);
  }
  const Chip& chip() const override { return soc_.chip_; }
  PowerSettings power_at_start() const override {
    return {soc_.clock_.hz(), soc_.cluster_ ? soc_.cluster_->clock_hz() : 0, soc_.voltage_mv_, 0, 0};
  }
  bool has_cluster() const override { return soc_.cluster_ != nullptr; }
  double clock_hz() const override { return soc_.clock_.hz(); }
  gap8_devices::Signals& signals() override { return soc_.signals_; }
  std::span<const std::uint8_t> flash() const override { return soc_.flash_; }
  const PictureRoll& pictures() const override { return *this; }
  std::string function() const override { return soc_.program_.where(soc_.hart_.pc()); }
  PartPort part_at(const BoardDevice& entry, std::string_view place) override {
    places_.push_back(fmt::format("{}.{}", entry.name, place));
    const auto found = std::ranges::find_if(soc_.board_.devices, [this](const BoardDevice& part) {
      return part.part && part.part->attached_to == places_.back();
    });
    if (found == soc_.board_.devices.end()) return {};
    return PartPort(dynamic_cast<AttachedPart*>(soc_.device(found->name)));
  }
  double load_energy_j(std::string_view load, Picoseconds now) const override {
    if (load == kChipLoad) return soc_.energy_at(now).total_j();
    const auto* device = soc_.device(load);
    MEBOTS_ASSERT(device != nullptr, "the reader of boards knows all loads");
    return device->energy_j(now);
  }
  std::span<const std::string> places() const override { return places_; }
  void picture_stored(const PictureTimes& times) override {
    soc_.decisions_.picture_stored(times, soc_.work_at(times.stored));
  }
  void setpoints_sent(std::string_view sender, Picoseconds now) override {
    soc_.decisions_.sent(sender, now, soc_.work_at(now));
    if (soc_.alone_) soc_.decisions_.published(now);
  }

 protected:
  std::vector<Device*> made_devices() const override {
    std::vector<Device*> made;
    for (const auto& device : soc_.owned_) made.push_back(device.get());
    return made;
  }

 private:
  bool exists() const override { return !soc_.pictures_.empty(); }
  std::span<const std::uint8_t> picture(std::size_t number) const override {
    if (number >= soc_.pictures_.size()) return {};
    return soc_.pictures_[number];
  }

  Soc& soc_;
  std::vector<std::string> places_;
};

}  // namespace mebots::soc
