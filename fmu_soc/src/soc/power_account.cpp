// SPDX-License-Identifier: Apache-2.0
#include "soc/power_account.hpp"

#include "mebots/soc/fixed_point.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::soc {
namespace {

Inventory inventory_of(const BoardDescription& board, const Settings& settings) {
  Inventory inventory;
  if (board.cluster_cores != 0) inventory.cluster_cores = settings.cluster_cores;
  for (const auto& memory : board.memories) {
    if (!memory.leaks) continue;
    (memory.place == Place::cluster ? inventory.l1_bytes : inventory.fc_memory_bytes) += memory.size;
  }
  return inventory;
}

}  // namespace

PowerAccount::PowerAccount(const Hardware& hardware, const Timeline& timeline, const Settings& settings)
    : hardware_(hardware),
      timeline_(timeline),
      meter_(hardware.chip().energy, inventory_of(hardware.board(), settings),
             {settings.temperature_c, settings.voltage_v, settings.clock_hz, settings.cluster_clock_hz}),
      temperature_c_(settings.temperature_c),
      voltage_mv_(static_cast<std::uint32_t>(std::lround(settings.voltage_v * kMilli))) {}

PowerState PowerAccount::power_state() const {
  const auto* cluster = hardware_.cluster();
  return {temperature_c_, voltage_mv_ / kMilli, static_cast<double>(timeline_.clock().hz()),
          cluster != nullptr ? static_cast<double>(cluster->clock_hz()) : 0.0};
}

/// For the fabric controller, the first memory is L2, and its accesses to all other memories, including L1, count as
/// fc_memory_accesses. For a core of the cluster, the first memory is L1, and all others are L2.
Activity PowerAccount::activity_at(Picoseconds now) const {
  const auto& counters = hardware_.controller().counters();
  Activity activity;
  activity.fc_instruction_fj = counters.instruction_fj;
  activity.fc_memory_accesses = counters.far_accesses;
  activity.l2_accesses = counters.near_accesses();
  activity.far_words = counters.device_accesses;
  if (const auto* cache = hardware_.instruction_cache()) {
    activity.l2_accesses += cache->refills() * cache->words_per_line();
  }
  activity.powered = now;
  activity.fc_asleep = timeline_.slept_at(now);
  activity.retained = timeline_.retention_at(now);
  const auto* cluster = hardware_.cluster();
  if (cluster == nullptr) return activity;
  const auto sums = cluster->counters();
  const auto& dma = cluster->dma().counts();
  const auto dma_words = dma.bytes / 4;
  activity.cluster_instruction_fj = sums.instruction_fj;
  activity.cluster_cycles = sums.cycles;
  activity.l1_accesses = sums.near_accesses() + dma_words;
  activity.l2_accesses += sums.far_accesses + dma_words;
  activity.far_words += sums.far_accesses + dma_words;
  activity.dma_cycles = dma.busy_cycles;
  if (const auto* cache = cluster->instruction_cache(); cache != nullptr) {
    const auto words = cache->refills() * cache->words_per_line();
    activity.l2_accesses += words;
    activity.far_words += words;
  }
  activity.cluster_powered = cluster->powered_time(now);
  for (unsigned core = 0; core < cluster->cores(); ++core) activity.of_cores[core] = core_activity(core);
  return activity;
}

CoreActivity PowerAccount::core_activity(unsigned core) const {
  const auto& counters = hardware_.hart(hart_of_core(static_cast<int>(core))).counters();
  return {counters.instruction_fj, counters.cycles, counters.near_accesses(), counters.far_accesses};
}

EnergyLedger PowerAccount::energy_at(Picoseconds time) const {
  const auto until = timeline_.supplied_until(time);
  // The last instruction may end after `until`. If it has changed the clock or the voltage, the meter has already
  // computed the energy up to the end of the instruction, and cannot compute it for earlier times.
  return meter_.at(activity_at(std::max(until, meter_.settled_until())));
}

CountEnergy PowerAccount::energy_per_count(unsigned hart) const {
  if (hart != kFabricControllerHart) return meter_.per_count_of_core();
  const auto* cluster = hardware_.cluster();
  return meter_.per_count_of_fabric_controller(cluster != nullptr && cluster->powered());
}

double PowerAccount::refill_words_per_fetch_cycle() const {
  const auto* cache = hardware_.instruction_cache();
  return cache != nullptr ? 1.0 * cache->words_per_line() / cache->refill_cycles() : 0;
}

void PowerAccount::visit(state::Visitor& v) {
  v("meter", meter_);
  v("voltage_mv", voltage_mv_);
}

}  // namespace mebots::soc
