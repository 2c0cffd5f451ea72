// SPDX-License-Identifier: Apache-2.0
#include "soc.hpp"

#include "cluster/own_peripherals.hpp"
#include "gap8_devices/cluster_peripherals.hpp"
#include "gap8_devices/fll.hpp"
#include "gap8_devices/soc_control.hpp"
#include "hart/csr_numbers.hpp"
#include "isa/encoding.hpp"
#include "mebots/assert.hpp"
#include "mebots/nearest_names.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

namespace mebots::soc {
namespace {

constexpr unsigned kArgument0 = 10;
constexpr Picoseconds kWithoutEnd = kNever - 1;
/// What lies below are registers that each core has for itself.
constexpr std::uint32_t kSharedDevices = 0x1000'0000;

Memory make_memory(const BoardDescription& board) {
  Memory memory;
  for (const auto& entry : board.memories) memory.add(entry.name, entry.base, entry.size);
  return memory;
}

/// The board's core, or the chip's when the board says nothing.
Timing timing_of(const BoardDescription& board, const Chip& chip) {
  auto timing = chip.timing;
  timing.kind = core_kind(board.core).value_or(timing.kind);
  return timing;
}

Inventory inventory_of(const BoardDescription& board, const Settings& settings) {
  Inventory inventory;
  if (board.cluster_cores != 0) inventory.cluster_cores = settings.cluster_cores;
  for (const auto& memory : board.memories) {
    if (!memory.leaks) continue;
    (memory.place == Place::cluster ? inventory.l1_bytes : inventory.fc_memory_bytes) += memory.size;
  }
  return inventory;
}

std::uint32_t checked_clock(const Chip& chip, const Settings& settings) {
  const auto clock_hz = static_cast<std::uint32_t>(std::llround(settings.clock_hz));
  const auto voltage_mv = static_cast<std::uint32_t>(std::lround(settings.voltage_v * kMilli));
  if (!chip.allows(clock_hz, voltage_mv)) {
    throw Error(fmt::format(
        "core.clock {} Hz at core.supply_voltage {} V is outside the chip's limits: {} to {} V in steps of "
        "{} mV, and {} to {:.0f} Hz at {} V",
        settings.clock_hz, settings.voltage_v, chip.lowest_voltage_v, chip.highest_voltage_v, chip.voltage_step_mv,
        chip.minimum_clock_hz, chip.highest_clock_hz(settings.voltage_v), settings.voltage_v));
  }
  return clock_hz;
}

std::uint32_t checked_cluster_clock(const Chip& chip, const Settings& settings) {
  const auto clock_hz = static_cast<std::uint32_t>(std::llround(settings.cluster_clock_hz));
  const auto voltage_mv = static_cast<std::uint32_t>(std::lround(settings.voltage_v * kMilli));
  if (!chip.allows_cluster(clock_hz, voltage_mv)) {
    throw Error(
        fmt::format("cluster.clock {} Hz at core.supply_voltage {} V is outside the chip's limits: {} to {:.0f} Hz",
                    settings.cluster_clock_hz, settings.voltage_v, chip.minimum_clock_hz,
                    chip.highest_cluster_clock_hz(settings.voltage_v)));
  }
  return clock_hz;
}

}  // namespace

/// What the chip does for its devices.
class Soc::Host final : public ChipHost, private gap8_devices::PictureRoll {
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
  std::span<const std::uint8_t> flash() override { return soc_.flash_; }
  const gap8_devices::PictureRoll& pictures() const override { return *this; }
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
  std::vector<Device*> devices() const override {
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

Soc::Soc(const BoardDescription& board, const Chip& chip, const Settings& settings, const Elf& program,
         Listeners listeners)
    : chip_(chip),
      listeners_(std::move(listeners)),
      program_(program),
      memory_(make_memory(board)),
      board_(board),
      kinds_(board_, settings.library_folders),
      flash_(settings.flash),
      pictures_(settings.pictures),
      host_(std::make_unique<Host>(*this)),
      hart_(memory_, *this, timing_of(board, chip), chip.instruction_energy),
      meter_(chip.energy, inventory_of(board, settings),
             {settings.temperature_c, settings.voltage_v, settings.clock_hz, settings.cluster_clock_hz}),
      temperature_c_(settings.temperature_c),
      voltage_mv_(static_cast<std::uint32_t>(std::lround(settings.voltage_v * kMilli))),
      decisions_(board.decisions_end_with) {
  clock_.reset(checked_clock(chip, settings));
  for (const auto& entry : board.memories) places_.push_back(entry.place);
  add_cluster(settings);
  add_devices();
  connect_memories();
  set_ways();
  load_program();
  if (const auto& cache = board.instruction_cache(Place::fabric_controller); cache.size != 0) {
    hart_.fetch_through(instruction_cache_.emplace(cache));
  }
  hart_.set_translation(settings.translate);
  hart_.set_id(board_.hart_id);
  if (event_unit_ != nullptr) hart_.use_event_unit();
  hart_.reset(program_.entry());
  apply_power_settings();  // what GAP8's own devices begin with
}

/// The way of the fabric controller to the memories, the large near ones first: the first two are the fast ones.
void Soc::connect_memories() {
  MEBOTS_ASSERT(places_.size() == memory_.regions().size());
  std::vector<MemoryPort> ports;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i] == Place::fabric_controller) ports.push_back({i, wait_of_fabric_controller(i), nullptr});
  }
  std::stable_sort(ports.begin(), ports.end(), [this](const auto& a, const auto& b) {
    return memory_.regions()[a.region].size > memory_.regions()[b.region].size;
  });
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (places_[i] == Place::cluster && cluster_ && cluster_->powered()) {
      ports.push_back({i, chip_.interconnect.fabric_controller_to_cluster, nullptr});
    }
  }
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const auto& alias = board_.memories[i].alias;
    if (alias && places_[i] == Place::fabric_controller) {
      ports.push_back({i, wait_of_fabric_controller(i), nullptr, *alias - board_.memories[i].base});
    }
  }
  hart_.connect(ports);
}

std::uint32_t Soc::wait_of_fabric_controller(std::size_t memory) const {
  const auto& way = board_.memories[memory].way;
  return way ? way->fabric_controller : 0;
}

/// The cluster's ways to memories whose board says how much of them lies in the clock of the SoC. An access, a refill
/// and a beat of the DMA take a cycle of the slower clock: the AXI bus between the two is as wide in both.
void Soc::set_ways() {
  if (!cluster_ || !has_ways()) return;
  const auto ticks_of = [&](std::uint64_t soc_cycles) {
    return static_cast<std::uint32_t>((soc_cycles * cluster_->clock_hz() + clock_.hz() - 1) / clock_.hz());
  };
  ClusterWays ways;
  ways.dma = chip_.dma;
  for (const auto& port : cluster_->ports()) {
    const auto& way = board_.memories[port.region].way;
    ways.waits.push_back(way ? way->cluster + ticks_of(way->soc) : port.wait_cycles);
  }
  const auto& cache = board_.instruction_cache(Place::cluster);
  ways.refill_cycles = cache.refill_cycles + ticks_of(cache.refill_soc_cycles);
  ways.access_ticks = ticks_of(1);
  // Of the memory that the DMA mostly works on, which is the largest one.
  const auto outside = std::ranges::find_if(
      cluster_->ports(), [&](const MemoryPort& port) { return board_.memories[port.region].way.has_value(); });
  const auto least = chip_.dma.latency - chip_.interconnect.cluster_to_soc;  // the DMA's own
  ways.dma.latency = least + ways.waits[static_cast<std::size_t>(outside - cluster_->ports().begin())];
  ways.dma.least_burst_cycles = chip_.dma.least_burst_of(ways.dma.latency);
  const auto beat = std::uint64_t{DmaTiming::kBeatUnit} * cluster_->clock_hz() / clock_.hz();
  ways.dma.beat_ticks = static_cast<std::uint32_t>(std::max<std::uint64_t>(beat, DmaTiming::kBeatUnit));
  cluster_->set_ways(ways);
  memory_.forget_code();  // what came through the cluster's instruction cache holds the cycles of a refill
}

bool Soc::has_ways() const {
  return std::ranges::any_of(board_.memories, [](const BoardMemory& memory) { return memory.way.has_value(); });
}

void Soc::add_cluster(const Settings& settings) {
  if (board_.cluster_cores == 0 || settings.cluster_cores == 0) return;
  if (settings.cluster_cores > board_.cluster_cores) {
    throw Error(fmt::format("cluster.cores {} is more than the {} of board {}", settings.cluster_cores,
                            board_.cluster_cores, board_.name));
  }
  ClusterSettings cluster;
  cluster.cores = settings.cluster_cores;
  cluster.clock_hz = checked_cluster_clock(chip_, settings);
  cluster.dma = chip_.dma;
  cluster.shares_way = has_ways();
  cluster.timing = timing_of(board_, chip_);
  cluster.instruction_cache = board_.instruction_cache(Place::cluster);
  cluster.translate = settings.translate;
  for (const auto place : {Place::cluster, Place::fabric_controller}) {
    for (std::size_t i = 0; i < board_.memories.size(); ++i) {
      if (board_.memories[i].place != place) continue;
      const auto wait = place == Place::cluster ? 0 : chip_.interconnect.cluster_to_soc;
      if (place == Place::cluster) cluster.l1_banks = board_.memories[i].banks;
      cluster.ports.push_back({i, wait, nullptr});
    }
    if (place == Place::cluster && cluster.ports.size() != 1) {
      throw Error(fmt::format("board {}: a cluster needs one memory at place \"cluster\", not {}", board_.name,
                              cluster.ports.size()));
    }
  }
  std::stable_sort(cluster.ports.begin() + 1, cluster.ports.end(), [this](const auto& a, const auto& b) {
    return memory_.regions()[a.region].size > memory_.regions()[b.region].size;
  });
  cluster.l1_region = cluster.ports.front().region;
  if (const auto& l1 = board_.memories[cluster.l1_region]; l1.alias) {
    cluster.ports.push_back({cluster.l1_region, 0, nullptr, *l1.alias - l1.base});
  }
  MEBOTS_ASSERT(cluster.l1_region < memory_.regions().size());
  choose_peripherals(cluster);
  cluster_ = std::make_unique<Cluster>(memory_, cluster, chip_.instruction_energy);
  if (cluster.has_gap8_interrupts) {
    cluster_->set_outside([this](const ClusterAccess& access, Picoseconds now) { return from_cluster(access, now); });
  }
  cluster_->set_watcher([this](std::uint32_t address) { return watched(address); });
}

/// GAP8's own, or those of our boards.
void Soc::choose_peripherals(ClusterSettings& cluster) {
  const auto entry_of = [this](std::string_view kind) {
    const auto found = std::ranges::find(board_.devices, kind, &BoardDevice::kind);
    return found == board_.devices.end() ? nullptr : &*found;
  };
  if (const auto* gap8 = entry_of(kGap8ClusterKind); gap8 != nullptr) {
    cluster.has_gap8_interrupts = true;
    cluster.make_peripherals = [this, &cluster, gap8](ClusterDma& dma) {
      return std::make_unique<gap8_devices::ClusterPeripherals>(
          *gap8, *host_,
          gap8_devices::ClusterPeripherals::Parts{cluster.cores, board_.memories[cluster.l1_region].base,
                                                  board_.memories[cluster.l1_region].size, &dma});
    };
    return;
  }
  const auto* event_unit = entry_of(kEventUnitKind);
  const auto* dma_entry = entry_of(kClusterDmaKind);
  if (event_unit == nullptr || dma_entry == nullptr) {
    throw Error(fmt::format("board {}: a cluster needs a device of kind {}, or one of kind {} and one of kind {}",
                            board_.name, kGap8ClusterKind, kEventUnitKind, kClusterDmaKind));
  }
  cluster_interrupt_ = event_unit->interrupt;
  cluster.make_peripherals = [&cluster, event_unit, dma_entry](ClusterDma& dma) {
    return std::make_unique<OwnPeripherals>(cluster.cores, event_unit->base, dma_entry->base, dma);
  };
}

/// Parts of the board first: devices ask for those that are attached to them.
void Soc::add_devices() {
  for (const auto& entry : board_.devices) {
    if (entry.is_on_bus()) continue;
    auto part = kinds_.make(entry, *host_);
    if (!part) {
      throw Error(fmt::format("board {}: {}: kind {} is part of the cluster and has an address", board_.name,
                              entry.name, entry.kind));
    }
    devices_.push_back({&entry, part.get()});
    owned_.push_back(std::move(part));
  }
  add_devices_on_bus();
  check_attachments();
}

/// That each part is attached to a place that there is, and to one of its own.
void Soc::check_attachments() const {
  std::vector<std::string> places(host_->places().begin(), host_->places().end());
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

void Soc::add_devices_on_bus() {
  for (const auto& entry : board_.devices) {
    if (!entry.is_on_bus()) continue;
    auto device = kinds_.make(entry, *host_);
    if (!device) continue;  // part of the cluster
    if (auto* power_manager = dynamic_cast<PowerManager*>(device.get())) {
      if (power_manager_ != nullptr) {
        throw Error(fmt::format("board {}: {} is a second power manager; a chip has one", board_.name, entry.name));
      }
      power_manager_ = power_manager;
    }
    if (auto* port = dynamic_cast<gap8_devices::EventUnitPort*>(device.get())) {
      if (event_unit_ != nullptr) {
        throw Error(
            fmt::format("board {}: {} is a second event unit; the fabric controller has one", board_.name, entry.name));
      }
      event_unit_ = &port->unit();
    }
    const bool sets_power = device.get() == power_manager_ ||
                            dynamic_cast<gap8_devices::Fll*>(device.get()) != nullptr ||
                            dynamic_cast<gap8_devices::SocControl*>(device.get()) != nullptr;
    slots_.push_back({entry.name, entry.base, entry.size(), entry.interrupt, device.get(), sets_power});
    for (const auto address : entry.also_at) {
      slots_.push_back({entry.name, address, entry.size(), -1, device.get()});
    }
    devices_.push_back({&entry, device.get()});
    owned_.push_back(std::move(device));
  }
}

void Soc::load_program() {
  for (const auto& segment : program_.segments()) {
    auto* region = memory_.find(segment.address, segment.size);
    if (region == nullptr) {
      throw Error(
          fmt::format("{}: segment at 0x{:08x} with {} bytes lies outside the board's memories; link it with the "
                      "board's addresses",
                      program_.origin(), segment.address, segment.size));
    }
    memory_.write(segment.address, segment.bytes);
  }
}

Device* Soc::device(std::string_view name) const {
  for (const auto& slot : devices_) {
    if (slot.entry->name == name) return slot.device;
  }
  return nullptr;
}

double* Soc::input(std::string_view variable) const {
  for (const auto& slot : devices_) {
    if (auto* found = slot.device->input(variable)) return found;
  }
  return nullptr;
}

const double* Soc::output(std::string_view variable) const {
  for (const auto& slot : devices_) {
    if (const auto* found = slot.device->output(variable)) return found;
  }
  return nullptr;
}

void Soc::begin_step() {
  if (end_ == End::powered_off) return;
  for (const auto& slot : devices_) slot.device->begin_step(now_);
}

void Soc::stop_when_stored(std::uint32_t address) {
  if (memory_.find(address, 4) == nullptr) {
    throw Error(fmt::format("{}: its symbol tohost is at 0x{:08x}, where there is no memory to watch",
                            program_.origin(), address));
  }
  stop_word_ = address;
  memory_.mark(address, 4, Region::kWatch);
}

bool Soc::poke(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  if (!memory_.write(address, bytes)) return false;
  memory_.changed(address, static_cast<std::uint32_t>(bytes.size()));
  return true;
}

const Soc::Slot* Soc::slot_at(std::uint32_t address) const {
  for (const auto& slot : slots_) {
    if (address >= slot.base && address - slot.base < slot.size) return &slot;
  }
  return nullptr;
}

/// Whether the cluster must come to the same time before the fabric controller touches what they share.
bool Soc::must_wait(std::uint32_t address, Picoseconds now) const {
  if (cluster_next() >= now) return false;
  if (cluster_->owns(address)) return true;
  const auto* slot = slot_at(address);
  return slot != nullptr && slot->sets_power;
}

BusReply Soc::load(std::uint32_t address, std::uint64_t cycle) {
  const auto now = clock_.time_of(cycle);
  if (must_wait(address, now)) return {BusReply::Kind::later};
  if (cluster_ && cluster_->owns(address)) {
    auto reply = cluster_->load(address, now);
    reply.wait_cycles += chip_.interconnect.fabric_controller_to_cluster;
    return reply;
  }
  const auto* slot = slot_at(address);
  std::uint32_t value = 0;
  if (slot == nullptr || !slot->device->load(address - slot->base, now, value)) return unmodelled(address, false, true);
  return BusReply::done(value, chip_.interconnect.fabric_controller_to_device);
}

/// A cluster core reaches a device of the SoC, which it finds as far on as the fabric controller does.
BusReply Soc::from_cluster(const ClusterAccess& access, Picoseconds time) {
  const auto now = asleep_ ? time : std::max(time, core_time());
  const auto* slot = slot_at(access.address);
  if (access.address < kSharedDevices) return {};
  if (slot == nullptr) return unmodelled(access.address, access.stored != nullptr, false);
  const auto offset = access.address - slot->base;
  const auto wait = chip_.interconnect.cluster_to_soc + chip_.interconnect.fabric_controller_to_device;
  if (access.stored != nullptr) {
    const bool stored = access.size == 4 ? slot->device->store(offset, now, *access.stored)
                                         : slot->device->store_narrow(offset, now, *access.stored, access.size);
    return stored ? BusReply::done(0, wait) : unmodelled(access.address, true, false);
  }
  std::uint32_t value = 0;
  return slot->device->load(offset, now, value) ? BusReply::done(value, wait)
                                                : unmodelled(access.address, false, false);
}

BusReply Soc::load_event(std::uint32_t address, std::uint64_t cycle) {
  const auto now = clock_.time_of(cycle);
  if (const auto* slot = slot_at(address); event_unit_ != nullptr && slot != nullptr &&
                                           dynamic_cast<gap8_devices::EventUnitDemux*>(slot->device) != nullptr) {
    return event_unit_->load_event(address - slot->base);
  }
  if (!cluster_ || !cluster_->owns(address)) return load(address, cycle);
  if (must_wait(address, now)) return {BusReply::Kind::later};
  auto reply = cluster_->load_event(address, now);
  reply.wait_cycles += chip_.interconnect.fabric_controller_to_cluster;
  return reply;
}

BusReply Soc::store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) {
  const auto now = clock_.time_of(cycle);
  if (must_wait(address, now)) return {BusReply::Kind::later};
  if (cluster_ && cluster_->owns(address)) {
    auto reply = cluster_->store(address, now, value);
    reply.wait_cycles += chip_.interconnect.fabric_controller_to_cluster;
    return reply;
  }
  const auto* slot = slot_at(address);
  if (slot == nullptr || !slot->device->store(address - slot->base, now, value)) return unmodelled(address, true, true);
  return BusReply::done(0, chip_.interconnect.fabric_controller_to_device);
}

/// An access that nothing answers; where it goes on, it takes as long as one that something answers.
BusReply Soc::unmodelled(std::uint32_t address, bool stores, bool by_fabric_controller) {
  if (event_unit_ == nullptr || !UnmodelledRegisters::are_at(address)) return {};
  if (unmodelled_.is_new(address) && listeners_.faults) {
    const auto* slot = slot_at(address);
    const auto found =
        slot == nullptr ? board_.devices.end() : std::ranges::find(board_.devices, slot->name, &BoardDevice::name);
    const auto* entry = found == board_.devices.end() ? nullptr : &*found;
    const auto function = by_fabric_controller ? host_->function() : std::string("a core of the cluster");
    listeners_.faults(unmodelled_.text(address, stores, function, entry));
  }
  const auto way = by_fabric_controller ? 0 : chip_.interconnect.cluster_to_soc;
  return BusReply::done(0, way + chip_.interconnect.fabric_controller_to_device);
}

bool Soc::watched(std::uint32_t /*address*/) {
  std::uint32_t word = 0;
  if (!stop_word_ || !memory_.read(*stop_word_, {reinterpret_cast<std::uint8_t*>(&word), sizeof word})) return false;
  if ((word & 1U) != 0) return true;
  return word != 0 && host_calls_ != nullptr && serve_system_call(word);
}

/// Of the HTIF, device 0: eight 64-bit words at `block`, number and arguments, of which the first takes the result.
/// True: the program ends. Source: riscv-isa-sim, fesvr/syscall.cc.
bool Soc::serve_system_call(std::uint32_t block) {
  std::array<std::uint64_t, 8> words{};
  const auto bytes = std::span(reinterpret_cast<std::uint8_t*>(words.data()), sizeof words);
  if (!memory_.read(block, bytes)) return false;
  std::array<std::uint32_t, 7> arguments{};
  for (std::size_t i = 0; i < arguments.size(); ++i) arguments[i] = static_cast<std::uint32_t>(words[i + 1]);
  const auto reply = host_calls_->system_call(static_cast<std::uint32_t>(words[0]), arguments);
  const auto store = [this](std::uint32_t address, auto value) {
    poke(address, {reinterpret_cast<const std::uint8_t*>(&value), sizeof value});
  };
  if (reply.exit_code) {
    store(*stop_word_, *reply.exit_code << 1 | 1U);
    return true;
  }
  store(block, static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(reply.value)}));
  store(*stop_word_, std::uint32_t{0});
  if (const auto from_host = program_.symbol("fromhost")) store(*from_host, std::uint32_t{1});
  return false;
}

/// An ebreak between two instructions that do nothing else. Source: RISC-V Semihosting 1.0.
bool Soc::called_host() {
  constexpr std::array<std::uint32_t, 3> kCall{0x01f01013, 0x00100073, 0x40705013};
  std::array<std::uint32_t, 3> words{};
  if (host_calls_ == nullptr) return false;
  if (!memory_.read(hart_.pc() - 4, {reinterpret_cast<std::uint8_t*>(words.data()), sizeof words})) return false;
  if (words != kCall) return false;
  const auto reply = host_calls_->semihosting(hart_.reg(kArgument0), hart_.reg(kArgument0 + 1));
  hart_.set_reg(kArgument0, reply.value);
  host_exit_ = reply.exit_code;
  return true;
}

void Soc::advance(std::int64_t time_ns) {
  alone_ = false;
  go_on(time_ns * kPsPerNs, kNoLimit);
  decisions_.published(now_);
}

void Soc::run_cycles(std::uint64_t cycle_limit) {
  alone_ = true;
  go_on(kWithoutEnd, cycle_limit);
}

void Soc::go_on(Picoseconds until, std::uint64_t cycle_limit) {
  tell(now_);
  for (;;) {
    const auto event = next_event();
    const auto cluster = cluster_next();
    if (cluster_ && cluster_->longest_cycles() >= cycle_limit) break;
    if (until == kWithoutEnd && !running()) break;  // timers of an ended program tick for ever
    if (asleep_) {
      const auto first = std::min(event, cluster);
      if (first > until || first == kNever) break;
      if (event <= cluster) {
        advance_devices(event);
        wake_if_interrupted(event);
      } else {
        // With a listener, one quantum after the other, so that it hears of each.
        advance_cluster(event, listener_ != nullptr ? cluster : until, cycle_limit);
      }
      tell(first);
      continue;
    }
    // The fabric controller goes ahead of the cluster, but not far.
    const auto lead = cluster == kNever ? kNever : cluster_->later(cluster, kLead);
    const auto stop_at = std::min(event, lead);
    const bool stop_comes = stop_at <= until;
    const auto limit = stop_comes ? clock_.first_at(stop_at) : clock_.first_after(until);
    const auto stop = hart_.run(std::min(limit, cycle_limit));
    if (stop != Stop::limit) {
      handle(stop);
      tell(core_time());
      continue;
    }
    if (hart_.counters().cycles < limit) {
      now_ = core_time();  // the cycle limit
      tell(now_);
      return;
    }
    if (!stop_comes) break;
    if (event <= lead) {
      advance_devices(event);
    } else {
      advance_cluster(lead, lead);
    }
    tell(core_time());
  }
  now_ = until == kWithoutEnd ? (asleep_ ? std::max(now_, asleep_since_) : core_time()) : until;
  tell(now_);
}

Picoseconds Soc::cluster_next() const {
  return cluster_ && running() ? cluster_->next() : kNever;
}

/// The cluster runs until it has caught up, or, while the fabric controller sleeps, for quanta that begin up to `last`
/// or until something may wake that one.
void Soc::advance_cluster(Picoseconds until, Picoseconds last, std::uint64_t cycle_limit) {
  do {
    cluster_->advance(until, last, cycle_limit);
    if (event_unit_ != nullptr) {  // a core may have used the devices of GAP8's SoC
      apply_power_settings();
      if (signals_.exit_code && running()) {
        finish(End::exited);
        return;
      }
    }
    update_lines();
    if (cluster_->take_fabric_wake()) hart_.wake();
    if (cluster_->faulted_core() >= 0) {
      finish(End::faulted);
      if (listeners_.faults) listeners_.faults(fault_text());
    } else if (cluster_->stopped()) {
      finish(cluster_->core_stopped_by_observer() >= 0 ? End::stopped : End::host);
    } else if (asleep_) {
      wake_if_interrupted(cluster_->fabric_event_time());
      return;
    }
  } while (cluster_next() < until);
}

void Soc::handle(Stop stop) {
  switch (stop) {
    case Stop::device:
      apply_power_settings();
      update_lines();
      if (host_exit_ || signals_.exit_code || (power_manager_ && power_manager_->exited())) {
        finish(End::exited);
        if (exited_on_exception() && listeners_.faults) listeners_.faults(fault_text());
      }
      break;
    case Stop::sleeping:
      asleep_ = true;
      asleep_since_ = core_time();
      retained_ = power_manager_ && power_manager_->settings().retention != 0;
      break;
    case Stop::watch:
      finish(End::host);
      break;
    case Stop::fault:
      finish(End::faulted);
      if (listeners_.faults) listeners_.faults(fault_text());
      break;
    case Stop::turn:
      advance_cluster(core_time(), core_time());
      break;
    case Stop::observer:
      finish(End::stopped);
      break;
    case Stop::limit:
      break;
  }
}

bool Soc::spins() const {
  if (end_ != End::none || hart_.sleeping() || hart_.interrupts_enabled()) return false;
  std::uint32_t word = 0;
  std::uint32_t fault_address = 0;
  if (!BlockCache::fetch(memory_, hart_.pc(), word, fault_address)) return false;
  const auto decoded = decode(word);
  if (decoded.op == Op::jal) return decoded.imm == 0 && decoded.rd == 0;
  return is_branch(decoded.op) && decoded.imm == 0 && decoded.rs1 == decoded.rs2 &&
         (decoded.op == Op::beq || decoded.op == Op::bge || decoded.op == Op::bgeu);
}

void Soc::finish(End why) {
  end_ = why;
  end_time_ = core_time();
  asleep_ = true;
  asleep_since_ = end_time_;
  for (const auto& slot : devices_) slot.device->program_ended();
}

void Soc::power_off() {
  if (end_ == End::powered_off) return;
  if (asleep_ && now_ > asleep_since_) slept_ += now_ - asleep_since_;
  retention_ = retention_time(now_);
  retained_ = false;
  end_ = End::powered_off;
  end_time_ = now_;
  asleep_ = true;
  asleep_since_ = kNever;
  for (const auto& slot : devices_) slot.device->program_ended();
}

Picoseconds Soc::next_event() const {
  if (end_ == End::powered_off) return kNever;
  auto next = kNever;
  for (const auto& slot : devices_) next = std::min(next, slot.device->next_event());
  return next;
}

void Soc::advance_devices(Picoseconds time) {
  for (const auto& slot : devices_) slot.device->advance(time);
  update_lines();
}

void Soc::update_lines() {
  if (event_unit_ != nullptr) {
    for (const auto& slot : slots_) {
      if (slot.interrupt >= 0 && slot.device->interrupt()) event_unit_->raise(static_cast<unsigned>(slot.interrupt));
    }
    hart_.set_interrupts(event_unit_->lines());
    if (event_unit_->take_wake()) hart_.wake();
    return;
  }
  for (const auto& slot : slots_) {
    if (slot.interrupt >= 0) hart_.set_interrupt(static_cast<unsigned>(slot.interrupt), slot.device->interrupt());
  }
  if (cluster_ && cluster_interrupt_ >= 0) {
    hart_.set_interrupt(static_cast<unsigned>(cluster_interrupt_), cluster_->interrupt());
  }
}

/// What the firmware asks of clocks, voltage and cluster; null when the board has nothing to ask.
const PowerSettings* Soc::power_settings() const {
  if (power_manager_ != nullptr) return &power_manager_->settings();
  return signals_.power ? &*signals_.power : nullptr;
}

BusReply Soc::load_narrow(std::uint32_t address, std::uint64_t cycle, unsigned size) {
  const auto* slot = slot_at(address);
  const auto offset = slot == nullptr ? 0 : address - slot->base;
  std::uint32_t value = 0;
  if (slot == nullptr || !slot->device->load_narrow(offset, clock_.time_of(cycle), value, size)) {
    return unmodelled(address, false, true);
  }
  return BusReply::done(value, chip_.interconnect.fabric_controller_to_device);
}

BusReply Soc::store_narrow(std::uint32_t address, std::uint64_t cycle, std::uint32_t value, unsigned size) {
  const auto* slot = slot_at(address);
  const auto offset = slot == nullptr ? 0 : address - slot->base;
  if (slot == nullptr || !slot->device->store_narrow(offset, clock_.time_of(cycle), value, size)) {
    return unmodelled(address, true, true);
  }
  return BusReply::done(0, chip_.interconnect.fabric_controller_to_device);
}

void Soc::interrupt_taken(unsigned line) {
  if (event_unit_ == nullptr) return;
  event_unit_->acknowledge(line);
  hart_.set_interrupts(event_unit_->lines());
}

void Soc::apply_power_settings() {
  const auto* settings = power_settings();
  if (settings == nullptr) return;
  const auto& wanted = *settings;
  const bool changed = wanted.clock_hz != clock_.hz() || wanted.voltage_mv != voltage_mv_ ||
                       (cluster_ && wanted.cluster_clock_hz != cluster_->clock_hz());
  const auto now = core_time();
  const auto before = changed ? activity_at(now) : Activity{};
  if (wanted.clock_hz != clock_.hz()) clock_.change(wanted.clock_hz, hart_.counters().cycles);
  if (cluster_ && wanted.cluster_clock_hz != cluster_->clock_hz()) cluster_->set_clock(now, wanted.cluster_clock_hz);
  voltage_mv_ = wanted.voltage_mv;
  if (changed) {
    meter_.change(power_state(), before);
    set_ways();
  }
  if (!cluster_) return;
  if ((wanted.cluster_on != 0) == cluster_->powered()) return;
  if (wanted.cluster_on != 0) {
    cluster_->power_on(now, wanted.cluster_boot);
  } else {
    cluster_->power_off(now);
  }
  connect_memories();
}

void Soc::wake_if_interrupted(Picoseconds time) {
  if (end_ != End::none || (hart_.sleeping() && !hart_.wakes())) return;
  auto wake = std::max(time, asleep_since_);
  if (retained_) {
    retention_ += wake - asleep_since_;
    retained_ = false;
    power_manager_->woken();
    hart_.flush_fetched();  // the memories are kept, the cache is not
    wake += std::llround(chip_.wake_up_s * kPsPerS);
  }
  clock_.wake(hart_.counters().cycles, wake);
  slept_ += core_time() - asleep_since_;
  asleep_ = false;
}

Picoseconds Soc::sleep_time() const {
  return slept_at(now_);
}

bool Soc::waits_for_picture() const {
  return std::ranges::any_of(devices_, [](const auto& slot) { return slot.device->takes_picture(); });
}

ChipState Soc::chip_state() const {
  if (end_ == End::powered_off) return ChipState::off;
  if (cluster_ && cluster_->powered()) return ChipState::cluster;
  if (!asleep_) return ChipState::controller;
  return waits_for_picture() ? ChipState::waiting : ChipState::asleep;
}

/// Something may have changed at `time`, or later, when it woke the core.
void Soc::tell(Picoseconds time) {
  const auto reached = asleep_ ? time : std::max(time, core_time());
  state_times_.pass(reached, chip_state());
  note_work(reached);
  if (listener_ != nullptr) listener_->changed(time);
}

/// The fabric controller has been awake, or has slept, up to `time`.
void Soc::note_work(Picoseconds time) {
  // Only where it changes: what the cluster is known to have done up to `time` depends on when it is asked.
  if (awake_noted_ == !asleep_) return;
  if (time > work_noted_) {
    controller_work_ = controller_work(time);
    work_noted_ = time;
    cluster_work_noted_ = cluster_ ? cluster_->busy_time(time) : 0;
  }
  awake_noted_ = !asleep_;
}

Picoseconds Soc::controller_work(Picoseconds now) const {
  const auto span = now - work_noted_;
  if (!awake_noted_ || span <= 0) return controller_work_;
  const auto of_cluster = cluster_ ? cluster_->busy_time(now) - cluster_work_noted_ : 0;
  return controller_work_ + span - std::clamp<Picoseconds>(of_cluster, 0, span);
}

Picoseconds Soc::slept_at(Picoseconds now) const {
  return slept_ + (asleep_ && now > asleep_since_ ? now - asleep_since_ : 0);
}

CoreWork Soc::work_at(Picoseconds now) const {
  CoreWork work;
  work.controller = controller_work(now);
  work.controller_awake = now - slept_at(now);
  if (!cluster_) return work;
  work.cluster = cluster_->busy_time(now);
  work.cluster_hz = cluster_->clock_hz();
  for (unsigned core = 0; core < cluster_->cores(); ++core) {
    work.core_cycles[core] = cluster_->hart(core).counters().cycles;
  }
  return work;
}

Picoseconds Soc::retention_time(Picoseconds now) const {
  return retention_ + (retained_ && now > asleep_since_ ? now - asleep_since_ : 0);
}

PowerState Soc::power_state() const {
  return {temperature_c_, voltage_mv_ / kMilli, static_cast<double>(clock_.hz()),
          cluster_ ? static_cast<double>(cluster_->clock_hz()) : 0.0};
}

/// What the chip did up to `now`. Of the fabric controller's accesses, the first memory is L2; those to L1 count as its
/// own memory's, over the interconnect. Of a cluster core's, the first is L1, all others are L2.
Activity Soc::activity_at(Picoseconds now) const {
  const auto& counters = hart_.counters();
  const auto far = hart_.far_accesses();
  Activity activity;
  activity.fc_instruction_fj = counters.instruction_fj;
  activity.fc_memory_accesses = far;
  activity.l2_accesses = counters.accesses - counters.device_accesses - far;
  activity.far_words = counters.device_accesses;
  if (instruction_cache_) activity.l2_accesses += instruction_cache_->refills() * instruction_cache_->words_per_line();
  activity.powered = now;
  activity.fc_asleep = slept_at(now);
  activity.retained = retention_time(now);
  if (!cluster_) return activity;
  const auto cluster = cluster_->counters();
  const auto cluster_far = cluster_->far_accesses();
  const auto& dma = cluster_->dma().counts();
  const auto dma_words = dma.bytes / 4;
  activity.cluster_instruction_fj = cluster.instruction_fj;
  activity.cluster_cycles = cluster.cycles;
  activity.l1_accesses = cluster.accesses - cluster.device_accesses - cluster_far + dma_words;
  activity.l2_accesses += cluster_far + dma_words;
  activity.far_words += cluster_far + dma_words;
  activity.dma_cycles = dma.busy_cycles;
  if (const auto* cache = cluster_->instruction_cache(); cache != nullptr) {
    const auto words = cache->refills() * cache->words_per_line();
    activity.l2_accesses += words;
    activity.far_words += words;
  }
  activity.cluster_powered = cluster_->powered_time(now);
  for (unsigned core = 0; core < cluster_->cores(); ++core) activity.of_cores[core] = core_activity(core);
  return activity;
}

CoreActivity Soc::core_activity(unsigned core) const {
  const auto& hart = cluster_->hart(core);
  const auto& counters = hart.counters();
  const auto far = hart.far_accesses();
  return {counters.instruction_fj, counters.cycles, counters.accesses - counters.device_accesses - far, far};
}

void Soc::observe(unsigned number, Observer* observer) {
  if (number == 0) {
    hart_.observe(observer);
  } else {
    cluster_->observe(number - 1, observer);
  }
}

std::uint64_t Soc::instructions() const {
  return hart_.counters().instructions + (cluster_ ? cluster_->counters().instructions : 0);
}

EnergyLedger Soc::energy_at(Picoseconds time) const {
  const auto until = end_ == End::powered_off ? std::min(time, end_time_) : time;
  // An instruction that begins before a point ends behind it. When it changes clock or voltage, what was before is
  // settled up to its end: less than that cannot be told any more.
  return meter_.at(activity_at(std::max(until, meter_.settled_until())));
}

CountEnergy Soc::energy_per_count(unsigned number) const {
  if (number != 0) return meter_.per_count_of_core();
  return meter_.per_count_of_fabric_controller(cluster_ && cluster_->powered());
}

std::vector<Soc::DeviceState> Soc::device_states() const {
  std::vector<DeviceState> states;
  for (const auto& slot : devices_) {
    if (const auto state = slot.device->state_name(); !state.empty()) states.push_back({slot.entry->name, state});
  }
  return states;
}

void Soc::visit(state::Visitor& v) {
  v("memory", memory_);
  if (instruction_cache_) v("instruction_cache", *instruction_cache_);
  v("hart", hart_);
  if (cluster_) v("cluster", *cluster_);
  for (const auto& slot : devices_) v(slot.entry->name, *slot.device);
  v("signals", signals_);
  v("meter", meter_);
  v("clock", clock_);
  v("voltage_mv", voltage_mv_);
  v("now", now_);
  v("end", end_);
  v("end_time", end_time_);
  v("asleep", asleep_);
  v("asleep_since", asleep_since_);
  v("slept", slept_);
  v("retained", retained_);
  v("retention", retention_);
  v("state_times", state_times_);
  v("decisions", decisions_);
  v("controller_work", controller_work_);
  v("work_noted", work_noted_);
  v("cluster_work_noted", cluster_work_noted_);
  v("awake_noted", awake_noted_);
  if (!v.restores()) return;
  connect_memories();
  set_ways();
}

}  // namespace mebots::soc
