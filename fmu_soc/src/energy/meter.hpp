// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"
#include "cluster/event_unit.hpp"
#include "energy/table.hpp"

#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>
#include <string_view>

namespace mebots::soc {

/// The parts of the chip's energy.
enum class Part : std::uint8_t {
  fabric_controller,   // its instructions, and its clock gate while it sleeps
  cluster_cores,       // the same for all cores of the cluster together
  fc_memory,           // accesses to the near memory of the fabric controller
  l2,                  // accesses
  l1,                  // accesses to banks
  interconnect,        // words between cluster and the rest, accesses to devices
  dma,                 // its transfers, and its clock
  fc_background,       // clock tree, bus and peripherals of its domain
  cluster_background,  // clock tree and bus of the cluster, while it is on
  leakage,             // of all powered domains
  retention,           // of memories in retention sleep
};
inline constexpr std::size_t kParts = 11;

/// Names of the parts in the FMU's variables.
inline constexpr std::array<std::string_view, kParts> kPartNames{
    "fabric_controller", "cluster_cores",      "fc_memory", "l2",       "l1", "interconnect", "dma",
    "fc_background",     "cluster_background", "leakage",   "retention"};

struct EnergyComponent {
  std::string_view name;
  double energy_j = 0;
};

/// Energy by part since reset [J].
struct EnergyLedger {
  std::array<double, kParts> by_part_j{};

  double operator[](Part part) const { return by_part_j[static_cast<std::size_t>(part)]; }
  double& operator[](Part part) { return by_part_j[static_cast<std::size_t>(part)]; }
  double total_j() const;
  /// Returns the parts of the total with their names.
  std::array<EnergyComponent, kParts> components() const;
  /// Energy by group: executed instructions; accesses and transfers; all other parts.
  double core_active_j() const;
  double memory_j() const;
  double standing_j() const;

  void visit(state::Visitor& v) { v("by_part_j", by_part_j); }
};

/// Counts of one core of the cluster since reset.
struct CoreActivity {
  std::uint64_t instruction_fj = 0;  // at the reference point
  std::uint64_t cycles = 0;          // awake
  std::uint64_t l1_accesses = 0;
  std::uint64_t far_accesses = 0;  // to L2, through the interconnect

  void visit(state::Visitor& v) {
    v("instruction_fj", instruction_fj);
    v("cycles", cycles);
    v("l1_accesses", l1_accesses);
    v("far_accesses", far_accesses);
  }
};

/// The energy [J] by which the total increases if one of a hart's counts increases by one. The settings and all other
/// counts stay the same.
struct CountEnergy {
  double cycle_j = 0;
  double instruction_j = 0;  // per femtojoule at the reference point
  double near_access_j = 0;
  double far_access_j = 0;
  double refill_word_j = 0;
};

/// Counts and durations of the chip since reset. All are integers.
struct Activity {
  std::uint64_t fc_instruction_fj = 0;       // at the reference point
  std::uint64_t cluster_instruction_fj = 0;  // at the reference point
  std::uint64_t fc_memory_accesses = 0;
  std::uint64_t l2_accesses = 0;
  std::uint64_t l1_accesses = 0;
  std::uint64_t far_words = 0;       // through the interconnect
  std::uint64_t dma_cycles = 0;      // of the cluster's clock, in which it moves data
  std::uint64_t cluster_cycles = 0;  // awake, sum over the cores
  Picoseconds powered = 0;
  Picoseconds fc_asleep = 0;
  Picoseconds cluster_powered = 0;
  Picoseconds retained = 0;  // part of `powered` in retention sleep
  std::array<CoreActivity, kMostClusterCores>
      of_cores{};  // the cluster's cores one by one; the sums above contain them

  void visit(state::Visitor& v) {
    v("fc_instruction_fj", fc_instruction_fj);
    v("cluster_instruction_fj", cluster_instruction_fj);
    v("fc_memory_accesses", fc_memory_accesses);
    v("l2_accesses", l2_accesses);
    v("l1_accesses", l1_accesses);
    v("far_words", far_words);
    v("dma_cycles", dma_cycles);
    v("cluster_cycles", cluster_cycles);
    v("powered", powered);
    v("fc_asleep", fc_asleep);
    v("cluster_powered", cluster_powered);
    v("retained", retained);
    v("of_cores", of_cores);
  }
};

/// Energies and powers of the chip, from params/*.json, object "energy".
struct EnergyTables {
  EnergyTable instruction;  // relative cost of an instruction: J at the point over J at the reference point
  double reference_instruction_j = 0;
  EnergyTable core_clock_gated;    // W of a sleeping core
  EnergyTable core_leakage;        // W of a core
  EnergyTable memory_access;       // J of a word in L2 or the fabric controller's memory
  EnergyTable l1_access;           // J of a word
  EnergyTable memory_leakage;      // W of 4 KiB
  EnergyTable interconnect_word;   // J
  EnergyTable dma_active;          // W while it moves data
  EnergyTable dma_background;      // W while the cluster is on
  EnergyTable fc_background;       // W
  EnergyTable cluster_background;  // W while the cluster is on
  EnergyTable cluster_leakage;     // W while the cluster is on, without cores and L1
  double retention_voltage_v = 0;
  double scale = 1;  // multiplies every energy

  /// Reads the tables. Records mistakes in the node's document.
  static EnergyTables read(const data::Node& node);
};

/// The settings that determine energy: supplies, clocks, temperature.
struct PowerState {
  double temperature_c = 25;
  double voltage_v = 1.2;
  double clock_hz = 0;
  double cluster_clock_hz = 0;

  void visit(state::Visitor& v) {
    v("temperature_c", temperature_c);
    v("voltage_v", voltage_v);
    v("clock_hz", clock_hz);
    v("cluster_clock_hz", cluster_clock_hz);
  }
};

/// Sizes of the chip's memories and number of cluster cores, on which the energies of the parts depend.
struct Inventory {
  std::uint32_t fc_memory_bytes = 0;  // memories of the fabric controller's domain, with L2
  std::uint32_t l1_bytes = 0;
  unsigned cluster_cores = 0;
};

/// Converts activity to energy. While the settings stay the same, energy is computed from the integers since the last
/// change, and never accumulated. Therefore the result does not depend on how often the energy is read.
class EnergyMeter {
 public:
  EnergyMeter(const EnergyTables& tables, const Inventory& inventory, const PowerState& state);

  EnergyLedger at(const Activity& now) const;
  /// Returns the energy of the instructions and accesses of core `number` of the cluster [J], without the energy of its
  /// gated clock. This energy is a part of the ledger.
  double core_j(unsigned number, const CoreActivity& now) const;
  /// Returns the energy of one more unit of each count. The energy of the fabric controller's counts is part of the
  /// ledger. The energy of a cluster core's counts is part of core_j().
  CountEnergy per_count_of_fabric_controller(bool cluster_on) const;
  CountEnergy per_count_of_core() const;
  /// Changes the settings from `now` on. Must be called before a clock changes the meaning of cycles.
  void change(const PowerState& state, const Activity& now);

  /// Returns the time of the last change of settings, since the supply was applied. The ledger of an earlier time is
  /// not available.
  Picoseconds settled_until() const { return since_.powered; }

  void visit(state::Visitor& v);

 private:
  /// Energies and powers at the present settings.
  struct Rates {
    double instruction = 1;  // relative to the reference point
    double core_gated_w = 0;
    double memory_access_j = 0;
    double l1_access_j = 0;
    double far_word_j = 0;
    double dma_active_w = 0;
    double dma_background_w = 0;
    double fc_background_w = 0;
    double cluster_background_w = 0;
    double leakage_w = 0;          // of domains that are always powered
    double cluster_leakage_w = 0;  // of the cluster's domain while it is on
    double retention_w = 0;
  };
  Rates rates_at(const PowerState& state) const;

  const EnergyTables& tables_;
  Inventory inventory_;
  PowerState state_;
  Rates rates_;
  Activity since_;        // at the last change
  EnergyLedger settled_;  // up to that change
  std::array<double, kMostClusterCores> settled_of_cores_j_{};
};

}  // namespace mebots::soc
