// SPDX-License-Identifier: Apache-2.0
#include "soc/device_set.hpp"

#include "devices/gap8/fll.hpp"
#include "devices/gap8/soc_control.hpp"
#include "mebots/error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace mebots::soc {

DeviceSet::DeviceSet(const BoardDescription& board, std::span<const std::filesystem::path> library_folders)
    : board_(board), kinds_(board, library_folders) {}

/// The parts are created before the devices, because devices look up the parts that are attached to them.
void DeviceSet::make(ChipHost& host) {
  add_parts(host);
  add_on_bus(host);
  connect_interrupts();
  check_attachments(host);
}

void DeviceSet::add_parts(ChipHost& host) {
  for (const auto& entry : board_.devices) {
    if (entry.is_on_bus()) continue;
    auto part = kinds_.make(entry, host);
    if (!part) {
      throw Error(fmt::format("board {}: {}: kind {} is part of the cluster and has an address", board_.name,
                              entry.name, entry.kind));
    }
    members_.push_back({&entry, part.get()});
    owned_.push_back(std::move(part));
  }
}

void DeviceSet::add_on_bus(ChipHost& host) {
  for (const auto& entry : board_.devices) {
    if (!entry.is_on_bus()) continue;
    auto device = kinds_.make(entry, host);
    if (!device) continue;  // the device is part of the cluster
    note_roles(entry, *device);
    const bool sets_power = device.get() == power_manager_ ||
                            dynamic_cast<gap8_devices::Fll*>(device.get()) != nullptr ||
                            dynamic_cast<gap8_devices::SocControl*>(device.get()) != nullptr;
    slots_.push_back({entry.name, entry.base, entry.size(), entry.interrupt, nullptr, device.get(), sets_power});
    for (const auto address : entry.also_at) {
      slots_.push_back({entry.name, address, entry.size(), -1, nullptr, device.get()});
    }
    members_.push_back({&entry, device.get()});
    owned_.push_back(std::move(device));
  }
}

void DeviceSet::connect_interrupts() {
  for (const auto& [entry, device] : members_) {
    if (entry->interrupt_controller.empty()) continue;
    auto* controller = dynamic_cast<InterruptController*>(find(entry->interrupt_controller));
    if (controller == nullptr) {
      throw Error(
          fmt::format("board {}: {}: interrupt_controller \"{}\" is a device of another kind; name one of kind "
                      "plic, or remove the key",
                      board_.name, entry->name, entry->interrupt_controller));
    }
    if (std::cmp_greater(entry->interrupt, controller->last_source())) {
      throw Error(fmt::format("board {}: {}: {} has no interrupt source {}; the last one is {}", board_.name,
                              entry->name, entry->interrupt_controller, entry->interrupt, controller->last_source()));
    }
    for (auto& slot : slots_) {
      if (slot.device == device) slot.controller = controller;
    }
  }
}

void DeviceSet::note_roles(const BoardDevice& entry, Device& device) {
  if (auto* power_manager = dynamic_cast<PowerManager*>(&device)) {
    if (power_manager_ != nullptr) {
      throw Error(fmt::format("board {}: {} is a second power manager; a chip has one", board_.name, entry.name));
    }
    power_manager_ = power_manager;
  }
  if (auto* port = dynamic_cast<gap8_devices::EventUnitPort*>(&device)) {
    if (event_unit_ != nullptr) {
      throw Error(
          fmt::format("board {}: {} is a second event unit; the fabric controller has one", board_.name, entry.name));
    }
    event_unit_ = &port->unit();
  }
}

/// Checks that each part is attached to an existing connection point, and that no two parts share a connection point.
void DeviceSet::check_attachments(const ChipHost& host) const {
  std::vector<std::string> places(host.places().begin(), host.places().end());
  for (const auto& entry : board_.devices) {
    if (!entry.part || entry.part->attached_to.empty()) continue;
    const auto found = std::ranges::find(places, entry.part->attached_to);
    if (found == places.end()) {
      throw Error(
          ErrorCode::unknown_name,
          fmt::format("board {}: part {}: attached_to \"{}\": no device has such a place, or another part is "
                      "attached there. {}",
                      board_.name, entry.name, entry.part->attached_to, suggest(entry.part->attached_to, places)));
    }
    places.erase(found);
  }
}

Device* DeviceSet::find(std::string_view name) const {
  for (const auto& member : members_) {
    if (member.entry->name == name) return member.device;
  }
  return nullptr;
}

double* DeviceSet::input(std::string_view variable) const {
  for (const auto& member : members_) {
    if (auto* found = member.device->input(variable)) return found;
  }
  return nullptr;
}

const double* DeviceSet::output(std::string_view variable) const {
  for (const auto& member : members_) {
    if (const auto* found = member.device->output(variable)) return found;
  }
  return nullptr;
}

std::vector<DeviceSet::State> DeviceSet::states() const {
  std::vector<State> states;
  for (const auto& member : members_) {
    if (const auto state = member.device->state_name(); !state.empty()) states.push_back({member.entry->name, state});
  }
  return states;
}

bool DeviceSet::wait_for_picture() const {
  return std::ranges::any_of(members_, [](const auto& member) { return member.device->takes_picture(); });
}

std::vector<Device*> DeviceSet::made() const {
  std::vector<Device*> made;
  for (const auto& device : owned_) made.push_back(device.get());
  return made;
}

void DeviceSet::begin_step(Picoseconds now) const {
  for (const auto& member : members_) member.device->begin_step(now);
}

void DeviceSet::end_program() {
  for (const auto& member : members_) member.device->program_ended();
  touch();
}

Picoseconds DeviceSet::next_event() {
  if (!cached_.next_event) {
    next_event_ = kNever;
    for (const auto& member : members_) next_event_ = std::min(next_event_, member.device->next_event());
    cached_.next_event = true;
  }
  return next_event_;
}

void DeviceSet::advance(Picoseconds time) {
  for (const auto& member : members_) member.device->advance(time);
  touch();
}

void DeviceSet::update_lines(Hart& hart, const Cluster* cluster, int cluster_interrupt) {
  const bool known = std::exchange(cached_.lines, true);
  if (event_unit_ != nullptr) {
    if (known) return;
    for (const auto& slot : slots_) {
      if (slot.interrupt >= 0 && slot.device->interrupt()) event_unit_->raise(static_cast<unsigned>(slot.interrupt));
    }
    hart.set_interrupts(event_unit_->lines());
    if (event_unit_->take_wake()) hart.wake();
    return;
  }
  if (!known) {
    for (const auto& slot : slots_) {
      if (slot.controller != nullptr && slot.interrupt >= 0) {
        slot.controller->set_source(static_cast<unsigned>(slot.interrupt), slot.device->interrupt());
      }
    }
    for (const auto& slot : slots_) {
      if (slot.controller == nullptr && slot.interrupt >= 0)
        hart.set_interrupt(static_cast<unsigned>(slot.interrupt), slot.device->interrupt());
    }
  }
  if (cluster != nullptr && cluster_interrupt >= 0) {
    hart.set_interrupt(static_cast<unsigned>(cluster_interrupt), cluster->interrupt());
  }
}

void DeviceSet::acknowledge(unsigned line, Hart& hart) {
  if (event_unit_ == nullptr) return;
  touch();
  event_unit_->acknowledge(line);
  hart.set_interrupts(event_unit_->lines());
}

const PowerSettings* DeviceSet::power_settings() const {
  if (power_manager_ != nullptr) return &power_manager_->settings();
  return signals_.power ? &*signals_.power : nullptr;
}

std::int32_t DeviceSet::exit_code() const {
  if (signals_.exit_code) return *signals_.exit_code;
  return power_manager_ != nullptr ? power_manager_->exit_code() : 0;
}

void DeviceSet::visit(state::Visitor& v) {
  for (const auto& member : members_) v(member.entry->name, *member.device);
  v("signals", signals_);
}

}  // namespace mebots::soc
