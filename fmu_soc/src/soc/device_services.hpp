// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/settings.hpp"
#include "devices/core/chip_host.hpp"
#include "soc/device_set.hpp"
#include "soc/hardware.hpp"
#include "soc/power_account.hpp"
#include "soc/program_host.hpp"
#include "soc/timeline.hpp"
#include "soc/work_account.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

/// Functions that receive the messages of a chip. Each may be empty.
struct Listeners {
  std::function<void(std::string_view line)> console;
  std::function<void(std::string_view text)> faults;
  std::function<void(std::string_view text)> observe = {};  // receives messages of debugger and profile
  /// Receives the bytes of serial ports. If it is empty, `console` receives their lines.
  std::function<void(std::uint8_t byte)> console_byte = {};
  /// Reads input for serial ports. Returns a byte, or another result of ConsolePort::read_console(). If `waits` is
  /// true, the core sleeps, and the function may wait for input until the wall clock has reached the time of the chip.
  std::function<int(Picoseconds now, bool waits)> console_input = {};
};

class DeviceServices final : public ChipHost, private PictureRoll {
 public:
  struct Parts {
    Hardware& hardware;
    const Timeline& timeline;
    DeviceSet& devices;
    const PowerAccount& power;
    WorkAccount& work;
    const ProgramHost& program_host;
    const Listeners& listeners;
  };

  DeviceServices(const Parts& parts, const Settings& settings)
      : parts_(parts), flash_(settings.flash), pictures_(settings.pictures) {}

  bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const override {
    return parts_.hardware.memory().read(address, bytes);
  }
  bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) override {
    return parts_.hardware.poke(address, bytes);
  }
  bool is_memory(std::uint32_t address, std::uint32_t size) const override {
    return parts_.hardware.memory().find(address, size) != nullptr;
  }
  void print(std::string_view line) override {
    if (parts_.listeners.console) parts_.listeners.console(line);
  }
  void complain(std::string_view text) override {
    if (parts_.listeners.faults) parts_.listeners.faults(text);
  }
  std::string function() const override { return parts_.program_host.function(); }
  void picture_stored(const PictureTimes& times) override { parts_.work.picture_stored(times); }
  void setpoints_sent(std::string_view sender, Picoseconds now) override { parts_.work.setpoints_sent(sender, now); }

  const Chip& chip() const override { return parts_.hardware.chip(); }
  PowerSettings power_at_start() const override;
  bool has_cluster() const override { return parts_.hardware.cluster() != nullptr; }
  double clock_hz() const override { return parts_.power.clock_hz(); }

  PartPort part_at(const BoardDevice& entry, std::string_view place) override;
  std::span<const std::string> places() const override { return places_; }
  double load_energy_j(std::string_view load, Picoseconds now) const override;

  std::span<const std::uint8_t> flash() const override { return flash_; }
  const PictureRoll& pictures() const override { return *this; }

  gap8_devices::Signals& signals() override { return parts_.devices.signals(); }

  bool write_console(std::uint8_t byte) override;
  int read_console(Picoseconds now) override;
  void end_program(std::int32_t exit_code) override { signals().exit_code = exit_code; }

 protected:
  std::vector<Device*> made_devices() const override { return parts_.devices.made(); }

 private:
  bool exists() const override { return !pictures_.empty(); }
  std::span<const std::uint8_t> picture(std::size_t number) const override {
    if (number >= pictures_.size()) return {};
    return pictures_[number];
  }

  Parts parts_;
  std::vector<std::uint8_t> flash_;
  std::vector<std::vector<std::uint8_t>> pictures_;
  std::vector<std::string> places_;
};

}  // namespace mebots::soc
