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

/// Parts into which the chip's energy is divided.
enum class Part : std::uint8_t {
  fabric_controller,   // instructions of the fabric controller, and its sleep with a gated clock
  cluster_cores,       // instructions and sleep of all cluster cores together
  fc_memory,           // accesses of the fabric controller to its near memory
  l2,                  // accesses to L2
  l1,                  // accesses to the banks of L1
  interconnect,        // words between the cluster and the rest of the chip, and accesses to devices
  dma,                 // transfers of the DMA, and its clock
  fc_background,       // clock tree, bus and peripherals in the fabric controller's domain
  cluster_background,  // clock tree and bus of the cluster while it is on
  leakage,             // leakage of all powered domains
  retention,           // memories during retention sleep
};
inline constexpr std::size_t kParts = 11;

/// Names of the parts in the FMU's variables, indexed by Part.
inline constexpr std::array<std::string_view, kParts> kPartNames{
    "fabric_controller", "cluster_cores",      "fc_memory", "l2",       "l1", "interconnect", "dma",
    "fc_background",     "cluster_background", "leakage",   "retention"};

struct EnergyComponent {
  std::string_view name;
  double energy_j = 0;
};

/// Energy of each part since reset [J].
struct EnergyLedger {
  std::array<double, kParts> by_part_j{};

  double operator[](Part part) const { return by_part_j[static_cast<std::size_t>(part)]; }
  double& operator[](Part part) { return by_part_j[static_cast<std::size_t>(part)]; }
  double total_j() const;
  std::array<EnergyComponent, kParts> components() const;
  /// Return the energy of executed instructions, of accesses and transfers, and of all other parts.
  double core_active_j() const;
  double memory_j() const;
  double standing_j() const;

  void visit(state::Visitor& v) { v("by_part_j", by_part_j); }
};

/// Counts of one cluster core since reset.
struct CoreActivity {
  std::uint64_t instruction_fj = 0;  // energy of the instructions at the reference temperature and voltage
  std::uint64_t cycles = 0;          // cycles in which the core was awake
  std::uint64_t l1_accesses = 0;
  std::uint64_t far_accesses = 0;  // accesses to L2 through the interconnect

  void visit(state::Visitor& v) {
    v("instruction_fj", instruction_fj);
    v("cycles", cycles);
    v("l1_accesses", l1_accesses);
    v("far_accesses", far_accesses);
  }
};

/// Energy [J] by which the total increases if one count of a hart increases by one.
struct CountEnergy {
  double cycle_j = 0;
  double instruction_j = 0;  // per femtojoule of Counters::instruction_fj
  double near_access_j = 0;
  double far_access_j = 0;
  double refill_word_j = 0;
};

/// Counts and durations of the chip since reset. All are integers.
struct Activity {
  std::uint64_t fc_instruction_fj = 0;       // energy of the instructions at the reference temperature and voltage
  std::uint64_t cluster_instruction_fj = 0;  // energy of the instructions at the reference temperature and voltage
  std::uint64_t fc_memory_accesses = 0;
  std::uint64_t l2_accesses = 0;
  std::uint64_t l1_accesses = 0;
  std::uint64_t far_words = 0;       // words through the interconnect
  std::uint64_t dma_cycles = 0;      // cycles of the cluster in which the DMA moves data
  std::uint64_t cluster_cycles = 0;  // sum of the cycles in which each core was awake
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

/// Tables of energy and power from the object "energy" of params/*.json.
struct EnergyTables {
  EnergyTable instruction;             // energy of an instruction; used relative to reference_instruction_j
  double reference_instruction_j = 0;  // value of `instruction` at the reference temperature and voltage
  EnergyTable core_clock_gated;        // power of a sleeping core [W]
  EnergyTable core_leakage;            // leakage of a core [W]
  EnergyTable memory_access;           // energy of a word in L2 or in the fabric controller's memory [J]
  EnergyTable l1_access;               // energy of a word in L1 [J]
  EnergyTable memory_leakage;          // leakage of 4 KiB [W]
  EnergyTable interconnect_word;       // energy of a word [J]
  EnergyTable dma_active;              // power while the DMA moves data [W]
  EnergyTable dma_background;          // power while the cluster is on [W]
  EnergyTable fc_background;           // power [W]
  EnergyTable cluster_background;      // power while the cluster is on [W]
  EnergyTable cluster_leakage;         // leakage while the cluster is on, without its cores and L1 [W]
  double retention_voltage_v = 0;
  double scale = 1;  // factor for all energies and powers

  /// Reads the tables. Reports mistakes to the document that contains the node.
  static EnergyTables read(const data::Node& node);
};

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

struct Inventory {
  std::uint32_t fc_memory_bytes = 0;  // size of the memories in the fabric controller's domain, including L2
  std::uint32_t l1_bytes = 0;
  unsigned cluster_cores = 0;
};

/// Converts the activity of the chip to energy. Computes the energy from the integer counts since the last change of
/// the settings, so that the result does not depend on how often the energy is read.
class EnergyMeter {
 public:
  EnergyMeter(const EnergyTables& tables, const Inventory& inventory, const PowerState& state);

  EnergyLedger at(const Activity& now) const;
  /// Returns by how much more energy cluster core `number` has used than a core with a gated clock [J]: the energy of
  /// its instructions and accesses, minus that of a gated clock in the same cycles. The result of at() also contains
  /// this difference.
  double core_j(unsigned number, const CoreActivity& now) const;
  /// These functions return the energies by which a result increases if one count increases by one, at the present
  /// temperature, voltage and clocks. per_count_of_fabric_controller() is for the fabric controller's counts and the
  /// result of at(). per_count_of_core() is for a cluster core's counts and the result of core_j().
  CountEnergy per_count_of_fabric_controller(bool cluster_on) const;
  CountEnergy per_count_of_core() const;
  /// Applies new settings from `now` on. Must be called before a clock changes, because the energy of a cycle depends
  /// on the clock.
  void change(const PowerState& state, const Activity& now);

  /// Returns the time for which the chip had been supplied at the last call of change(). at() cannot compute the energy
  /// up to earlier times.
  Picoseconds settled_until() const { return since_.powered; }

  void visit(state::Visitor& v);

 private:
  /// Energies and powers at the present temperature, voltage and clocks.
  struct Rates {
    double instruction = 1;  // relative to reference_instruction_j
    double core_gated_w = 0;
    double memory_access_j = 0;
    double l1_access_j = 0;
    double far_word_j = 0;
    double dma_active_w = 0;
    double dma_background_w = 0;
    double fc_background_w = 0;
    double cluster_background_w = 0;
    double leakage_w = 0;          // leakage of the domains that are always powered
    double cluster_leakage_w = 0;  // leakage of the cluster's domain while it is on
    double retention_w = 0;
  };
  Rates rates_at(const PowerState& state) const;

  const EnergyTables& tables_;
  Inventory inventory_;
  PowerState state_;
  Rates rates_;
  Activity since_;        // activity at the last change of settings
  EnergyLedger settled_;  // energy up to the last change of settings
  std::array<double, kMostClusterCores> settled_of_cores_j_{};
};

}  // namespace mebots::soc
