// SPDX-License-Identifier: Apache-2.0
#include "soc/hardware.hpp"

#include "cluster/own_peripherals.hpp"
#include "devices/gap8/cluster_peripherals.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/fixed_point.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

namespace mebots::soc {
namespace {

Memory make_memory(const BoardDescription& board) {
  Memory memory;
  for (const auto& entry : board.memories) memory.add(entry.name, entry.base, entry.size);
  return memory;
}

/// Returns the timing of the core that the board names. If the board names no core, uses the chip's core.
Timing timing_of(const BoardDescription& board, const Chip& chip) {
  auto timing = chip.timing;
  timing.kind = core_kind(board.core).value_or(timing.kind);
  timing.options = board.isa;
  timing.pmp_entries = board.pmp_entries;
  return timing;
}

/// Returns the board's first device of a kind, or null if the board has no such device.
const BoardDevice* device_of(const BoardDescription& board, std::string_view kind) {
  const auto found = std::ranges::find(board.devices, kind, &BoardDevice::kind);
  return found == board.devices.end() ? nullptr : &*found;
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

Hardware::Hardware(const BoardDescription& board, const Chip& chip, const Settings& settings, Bus& bus)
    : chip_(chip),
      board_(board),
      memory_(make_memory(board)),
      instruction_cache_(
          make_instruction_cache(board.instruction_cache(Place::fabric_controller), InstructionCache::Users::one)),
      decoded_(memory_, {.timing = timing_of(board, chip),
                         .energy = chip.instruction_energy,
                         .instruction_cache = instruction_cache_.get(),
                         .translate = settings.translate}),
      controller_(memory_, bus, decoded_,
                  {.id = board.hart_id,
                   .keeps_written_mtvec = settings.keeps_written_mtvec,
                   .has_gap8_interrupts = device_of(board, kGap8EventUnitKind) != nullptr}) {}

/// The first two memories are on the fast path. Therefore large memories with short latencies come first.
void Hardware::connect_memories() {
  MEBOTS_ASSERT(board_.memories.size() == memory_.regions().size());
  std::vector<MemoryPort> ports;
  for (std::size_t i = 0; i < board_.memories.size(); ++i) {
    if (board_.memories[i].place == Place::fabric_controller) ports.push_back({i, wait_of_controller(i), nullptr});
  }
  std::stable_sort(ports.begin(), ports.end(), [this](const auto& a, const auto& b) {
    return memory_.regions()[a.region].size > memory_.regions()[b.region].size;
  });
  for (std::size_t i = 0; i < board_.memories.size(); ++i) {
    if (board_.memories[i].place == Place::cluster && cluster_ && cluster_->powered()) {
      ports.push_back({i, chip_.interconnect.fabric_controller_to_cluster, nullptr});
    }
  }
  for (std::size_t i = 0; i < board_.memories.size(); ++i) {
    const auto& alias = board_.memories[i].alias;
    if (alias && board_.memories[i].place == Place::fabric_controller) {
      ports.push_back({i, wait_of_controller(i), nullptr, *alias - board_.memories[i].base});
    }
  }
  controller_.connect(ports);
}

std::uint32_t Hardware::wait_of_controller(std::size_t memory) const {
  const auto& latency = board_.memories[memory].latency;
  return latency ? latency->fabric_controller : 0;
}

/// Only has an effect if the board states latencies in cycles of the SoC's clock. An access, a refill and a beat of the
/// DMA each take at least one cycle of the slower clock, because the AXI bus between the clock domains has the same
/// width on both sides.
void Hardware::set_latencies(std::uint32_t soc_hz) {
  if (!cluster_ || !has_latencies()) return;
  const auto ticks_of = [&](std::uint64_t soc_cycles) {
    return static_cast<std::uint32_t>((soc_cycles * cluster_->clock_hz() + soc_hz - 1) / soc_hz);
  };
  ClusterLatencies latencies;
  latencies.dma = chip_.dma;
  for (const auto& port : cluster_->ports()) {
    const auto& latency = board_.memories[port.region].latency;
    latencies.waits.push_back(latency ? latency->cluster + ticks_of(latency->soc) : port.wait_cycles);
  }
  const auto& cache = board_.instruction_cache(Place::cluster);
  latencies.refill_cycles = cache.refill_cycles + ticks_of(cache.refill_soc_cycles);
  latencies.access_ticks = ticks_of(1);
  // The DMA gets the latency of the largest memory outside the cluster, because it mainly accesses this memory.
  const auto outside = std::ranges::find_if(
      cluster_->ports(), [&](const MemoryPort& port) { return board_.memories[port.region].latency.has_value(); });
  const auto least = chip_.dma.latency - chip_.interconnect.cluster_to_soc;  // latency of the DMA itself
  latencies.dma.latency = least + latencies.waits[static_cast<std::size_t>(outside - cluster_->ports().begin())];
  latencies.dma.least_burst_cycles = chip_.dma.least_burst_of(latencies.dma.latency);
  const auto beat = std::uint64_t{DmaTiming::kBeatUnit} * cluster_->clock_hz() / soc_hz;
  latencies.dma.beat_ticks = static_cast<std::uint32_t>(std::max<std::uint64_t>(beat, DmaTiming::kBeatUnit));
  cluster_->set_latencies(latencies);
}

bool Hardware::has_latencies() const {
  return std::ranges::any_of(board_.memories, [](const BoardMemory& memory) { return memory.latency.has_value(); });
}

void Hardware::add_cluster(const Settings& settings, DeviceHost& host) {
  if (board_.cluster_cores == 0 || settings.cluster_cores == 0) return;
  if (settings.cluster_cores > board_.cluster_cores) {
    throw Error(fmt::format("cluster.cores {} is more than the {} of board {}", settings.cluster_cores,
                            board_.cluster_cores, board_.name));
  }
  ClusterSettings cluster;
  cluster.cores = settings.cluster_cores;
  cluster.clock_hz = checked_cluster_clock(chip_, settings);
  cluster.dma = chip_.dma;
  cluster.shares_soc_port = has_latencies();
  cluster.timing = timing_of(board_, chip_);
  cluster.instruction_cache = board_.instruction_cache(Place::cluster);
  cluster.translate = settings.translate;
  for (const auto place : {Place::cluster, Place::fabric_controller}) {
    for (std::size_t i = 0; i < board_.memories.size(); ++i) {
      if (board_.memories[i].place != place) continue;
      const auto wait = place == Place::cluster ? 0 : chip_.interconnect.cluster_to_soc;
      if (place == Place::cluster) {
        cluster.l1_banks = board_.memories[i].banks;
        cluster.arbitration_tree = board_.memories[i].arbitration_tree;
        cluster.quantum = board_.memories[i].quantum;
      }
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
  choose_peripherals(cluster, host);
  cluster_ = std::make_unique<Cluster>(memory_, cluster, chip_.instruction_energy);
}

/// Selects the cluster's registers: those of GAP8, or those of MEbots' boards.
void Hardware::choose_peripherals(ClusterSettings& cluster, DeviceHost& host) {
  if (const auto* gap8 = device_of(board_, kGap8ClusterKind); gap8 != nullptr) {
    cluster.has_gap8_interrupts = true;
    cluster.make_peripherals = [this, &cluster, &host, gap8](ClusterDma& dma) {
      return std::make_unique<gap8_devices::ClusterPeripherals>(
          *gap8, host,
          gap8_devices::ClusterPeripherals::Parts{cluster.cores, board_.memories[cluster.l1_region].base,
                                                  board_.memories[cluster.l1_region].size, &dma});
    };
    return;
  }
  const auto* event_unit = device_of(board_, kEventUnitKind);
  const auto* dma_entry = device_of(board_, kClusterDmaKind);
  if (event_unit == nullptr || dma_entry == nullptr) {
    throw Error(fmt::format("board {}: a cluster needs a device of kind {}, or one of kind {} and one of kind {}",
                            board_.name, kGap8ClusterKind, kEventUnitKind, kClusterDmaKind));
  }
  cluster_interrupt_ = event_unit->interrupt;
  cluster.make_peripherals = [&cluster, event_unit, dma_entry](ClusterDma& dma) {
    return std::make_unique<OwnPeripherals>(cluster.cores, event_unit->base, dma_entry->base, dma);
  };
}

void Hardware::load_program(const Elf& program, const DeviceSet& devices) {
  for (const auto& segment : program.segments()) {
    const auto size = static_cast<std::uint32_t>(segment.bytes.size());
    if (!memory_.covers(segment.load_address, size))
      fail_outside(program, segment, "is loaded", segment.load_address, size);
    // A linker script may describe a device's registers as a section without bytes. This section need not be in a
    // memory.
    const bool is_device = segment.bytes.empty() && devices.slot_at(segment.run_address) != nullptr;
    if (!is_device && !runs_in_memory(segment.run_address, segment.size)) {
      fail_outside(program, segment, "runs", segment.run_address, segment.size);
    }
    for (std::span<const std::uint8_t> rest = segment.bytes; !rest.empty();) {
      const auto at = segment.load_address + static_cast<std::uint32_t>(segment.bytes.size() - rest.size());
      const auto* region = memory_.find(at, 1);
      const auto here = std::min<std::size_t>(rest.size(), region->base + region->size - at);
      memory_.write(at, rest.first(here));
      rest = rest.subspan(here);
    }
  }
}

bool Hardware::runs_in_memory(std::uint32_t address, std::uint32_t size) const {
  return memory_.covers(address, size) || std::ranges::any_of(board_.memories, [&](const auto& memory) {
           return memory.alias && address >= *memory.alias &&
                  std::uint64_t{address} + size <= std::uint64_t{*memory.alias} + memory.size;
         });
}

void Hardware::fail_outside(const Elf& program, const ElfSegment& segment, std::string_view what, std::uint32_t address,
                            std::uint32_t size) const {
  std::string memories;
  for (const auto& region : memory_.regions()) {
    memories += fmt::format("{}{} from 0x{:08x} to 0x{:08x}", memories.empty() ? "" : ", ", region.name, region.base,
                            region.base + (region.size - 1));
  }
  const auto other =
      segment.load_address == segment.run_address
          ? std::string()
          : fmt::format(" (load address 0x{:08x}, run address 0x{:08x})", segment.load_address, segment.run_address);
  throw Error(fmt::format(
      "{}: a segment{} {} at 0x{:08x} with {} bytes; this lies outside the board's memories (board {}: {}); "
      "link the program with the board's addresses, or add a memory to the board",
      program.origin(), other, what, address, size, board_.name, memories));
}

bool Hardware::poke(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  if (!memory_.write(address, bytes)) return false;
  memory_.changed(address, static_cast<std::uint32_t>(bytes.size()));
  return true;
}

void Hardware::visit(state::Visitor& v) {
  v("memory", memory_);
  if (instruction_cache_) v("instruction_cache", *instruction_cache_);
  v("hart", controller_);
  if (cluster_) v("cluster", *cluster_);
}

}  // namespace mebots::soc
