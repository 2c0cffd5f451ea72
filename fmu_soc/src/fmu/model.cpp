// SPDX-License-Identifier: Apache-2.0
#include "fmu/model.hpp"

#include "board/board_file.hpp"
#include "board/network_folder.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::soc {
namespace {

constexpr double kPicosecond = 1e-12;
constexpr double kNanosecond = 1e-9;

/// The outputs are in the order of the enumeration Part.
constexpr std::array<double Outputs::*, kParts> kPartPowers{
    &Outputs::power_fabric_controller_w,
    &Outputs::power_cluster_cores_w,
    &Outputs::power_fc_memory_w,
    &Outputs::power_l2_w,
    &Outputs::power_l1_w,
    &Outputs::power_interconnect_w,
    &Outputs::power_dma_w,
    &Outputs::power_fc_background_w,
    &Outputs::power_cluster_background_w,
    &Outputs::power_leakage_w,
    &Outputs::power_retention_w,
};
static_assert(std::tuple_size_v<decltype(Outputs::energy_j)> == kParts);
static_assert(std::tuple_size_v<decltype(Outputs::state_time_s)> == StateTimes::kCounted);
static_assert(std::tuple_size_v<decltype(Outputs::cluster_core_cycles)> == kMostClusterCores);
static_assert(std::tuple_size_v<decltype(Outputs::decision_s)> == kDecisionParts);
static_assert(std::tuple_size_v<decltype(Outputs::decision_mean_awake_s)> == kMostHarts);

Settings settings_of(const Parameters& parameters) {
  Settings settings;
  settings.clock_hz = parameters.core_clock_hz;
  settings.cluster_clock_hz = parameters.cluster_clock_hz;
  settings.cluster_cores = static_cast<unsigned>(parameters.cluster_cores);
  settings.temperature_c = parameters.temperature_degc;
  settings.voltage_v = parameters.core_supply_voltage_v;
  return settings;
}

/// Returns the file name of the default firmware in the FMU's resources, or an empty name if the FMU contains no
/// firmware.
constexpr std::string_view firmware_inside() {
  return MEBOTS_SOC_FIRMWARE;
}

/// Returns the names of the programs inside the FMU, in alphabetical order.
std::vector<std::string> programs_in(const std::filesystem::path& resources) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(resources)) {
    if (entry.path().extension() == ".elf") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

Elf firmware_with_network(const Parameters& parameters, const BoardDescription& board) {
  const auto inside = std::filesystem::path(firmware_inside()).stem().string();
  try {
    return Elf::read(
        program_with_network(parameters.network, parameters.firmware.empty() ? inside : parameters.firmware, board));
  } catch (const Error& error) {
    throw Error(fmt::format("network = \"{}\": {}", parameters.network, error.what()));
  }
}

/// Reads the firmware of the mission. If the parameter `network` is set, reads the firmware with this network.
/// Otherwise the parameter `firmware` is the name of a program in the FMU or, if the FMU contains no such program, a
/// path. If it is empty, reads the FMU's default firmware.
Elf firmware_of(const Parameters& parameters, const std::filesystem::path& resources, const BoardDescription& board) {
  if (!parameters.network.empty()) return firmware_with_network(parameters, board);
  if (parameters.firmware.empty()) {
    if (firmware_inside().empty()) {
      throw Error(fmt::format(
          "firmware = \"\": this FMU has board {} and contains no program; set it to the path of an ELF file",
          MEBOTS_SOC_BOARD));
    }
    return Elf::read(resources / firmware_inside());
  }
  const auto inside = programs_in(resources);
  if (std::find(inside.begin(), inside.end(), parameters.firmware) != inside.end()) {
    return Elf::read(resources / (parameters.firmware + ".elf"));
  }
  try {
    require_own_chip(parameters.firmware, board);
    return Elf::read(parameters.firmware);
  } catch (const Error& error) {
    const auto names = inside.empty() ? "" : fmt::format("; inside the FMU: {}", fmt::join(inside, ", "));
    throw Error(fmt::format("firmware = \"{}\": {}{}", parameters.firmware, error.what(), names));
  }
}

observe::Requests requests_of(const Parameters& parameters) {
  const auto path = [](const std::string& text) {
    return text.empty() ? std::nullopt : std::optional<std::string>(text);
  };
  observe::Requests requests;
  requests.names = {"observe.trace", "observe.profile", "observe.power_trace"};
  requests.trace = path(parameters.observe_trace);
  requests.profile = path(parameters.observe_profile);
  requests.power_trace = path(parameters.observe_power_trace);
  if (parameters.gdb_port >= 0) requests.gdb_port = parameters.gdb_port;
  requests.gdb_kill = debug::GdbServer::Kill::detaches;
  return requests;
}

/// Returns true if gdb can return to earlier instructions. It cannot if a recording was requested, because the file
/// would contain repeated instructions.
bool is_reversible(const observe::Requests& requests) {
  return requests.gdb_port && !requests.writes();
}

/// Returns listeners that receive nothing while a debugger repeats a part of the run.
Listeners muted_in_replay(Listeners listeners, const std::optional<Past>& past) {
  if (!past) return listeners;
  for (auto* listener : {&listeners.console, &listeners.faults}) {
    if (!*listener) continue;
    *listener = [inner = *listener, &past](std::string_view text) {
      if (!past->history.repeats()) inner(text);
    };
  }
  return listeners;
}

}  // namespace

Model::Model(Variables& variables, const std::filesystem::path& resources, Listeners listeners)
    : Model(variables, resources, read_board(resources / MEBOTS_SOC_BOARD), std::move(listeners)) {}

Model::Model(Variables& variables, const std::filesystem::path& resources, const BoardDescription& board,
             Listeners listeners)
    : variables_(variables),
      past_(is_reversible(requests_of(variables.parameters)) ? std::make_optional<Past>() : std::nullopt),
      listeners_(muted_in_replay(std::move(listeners), past_)),
      energies_(variables.parameters.energy_name.empty() ? board.energy : variables.parameters.energy_name),
      chip_(calibrated_chip(energies_, variables.parameters.calibration_energy)),
      soc_(board, chip_, settings_of(variables.parameters), firmware_of(variables.parameters, resources, board),
           listeners_),
      fields_(soc_, &variables) {
  auto requests = requests_of(variables.parameters);
  requests.announce = [this](std::string_view text) {
    if (listeners_.observe) listeners_.observe(text);
  };
  if (past_) requests.history = &past_->history;
  if (requests.any()) session_ = std::make_unique<observe::Session>(requests, soc_);
}

Model::~Model() {
  if (!session_) return;
  try {
    session_->finish(soc_.exit_code());
  } catch (const std::exception& error) {
    if (listeners_.observe) listeners_.observe(error.what());
  }
}

void Model::start(std::int64_t start_ns) {
  origin_ns_ = start_ns;
  const auto& checks = soc_.energy_checks();
  variables_.outputs.energy_checks =
      fmt::format("{} checks of {}: silicon / model is {:.2f} to {:.2f}; not a confidence interval", checks.count,
                  energies_, checks.least, checks.most);
  take_inputs();
  write(0);
}

void Model::step(std::int64_t start_ns, std::int64_t duration_ns) {
  if (duration_ns > kLongestNs - (start_ns - origin_ns_)) {
    throw Error(fmt::format(
        "the step would end more than {} s after its start; the chip's time in picoseconds cannot represent that",
        kLongestNs / 1'000'000'000));
  }
  if (session_) session_->checkpoint();
  take_inputs();
  const auto energy_before = soc_.energy();
  advance(start_ns - origin_ns_ + duration_ns);
  if (session_) session_->stepped();
  report_spinning();
  const auto duration_s = static_cast<double>(duration_ns) * kNanosecond;
  write(duration_s);
  const auto energy_after = soc_.energy();
  auto& outputs = variables_.outputs;
  outputs.power_w = (energy_after.total_j() - energy_before.total_j()) / duration_s;
  for (std::size_t i = 0; i < kParts; ++i) {
    outputs.*kPartPowers[i] = (energy_after.by_part_j[i] - energy_before.by_part_j[i]) / duration_s;
  }
}

/// Reports once that the program is in an endless loop. Does not end the mission.
void Model::report_spinning() {
  if (spinning_reported_ || !soc_.spins()) return;
  spinning_reported_ = true;
  if (!listeners_.faults) return;
  const auto pc = soc_.hart().pc();
  listeners_.faults(
      fmt::format("the core is in an endless jump to itself at pc 0x{:08x} in {}: no enabled interrupt can end it", pc,
                  soc_.program().where(pc)));
}

void Model::advance(std::int64_t end_ns) {
  if (past_) past_->begin_step(soc_.now(), end_ns, fields_);
  soc_.advance(end_ns);
  while (session_ && session_->rewind()) replay();
}

/// Repeats the steps of the mission from the restored state to the present step, or until gdb requests an earlier
/// instruction again.
void Model::replay() {
  for (auto i = past_->current_step(soc_.now()); i < past_->steps.size() && !past_->history.leaves(); ++i) {
    past_->repeat_step(i, soc_.now());
    session_->checkpoint();
    fields_.set(past_->steps[i].inputs);
    begin_step();
    soc_.advance(past_->steps[i].end_ns);
  }
}

void Model::take_inputs() {
  fields_.take();
  begin_step();
}

void Model::begin_step() {
  const auto least_v = soc_.board().supply.least_v;
  if (const auto* supply_v = fields_.supply_v();
      supply_v != nullptr && *supply_v < least_v && soc_.end() != End::powered_off) {
    soc_.power_off();
    if (listeners_.faults) {
      listeners_.faults(fmt::format("{} {} V is under {} V: the chip lost its power at {:.9g} s",
                                    soc_.board().supply.variable, *supply_v, least_v,
                                    static_cast<double>(soc_.now()) * kPicosecond));
    }
  }
  soc_.begin_step();
}

/// `step_s` is the duration of the completed step; 0 = no step was completed.
void Model::write(double step_s) {
  auto& outputs = variables_.outputs;
  const auto& counters = soc_.hart().counters();
  const auto energy = soc_.energy();
  outputs.instructions = static_cast<double>(counters.instructions);
  outputs.cycles = static_cast<double>(counters.cycles);
  outputs.sleep_time_s = static_cast<double>(soc_.sleep_time()) * kPicosecond;
  for (std::size_t i = 0; i < StateTimes::kCounted; ++i) {
    outputs.state_time_s[i] = static_cast<double>(soc_.state_times().total(i)) * kPicosecond;
  }
  outputs.core_running = soc_.running();
  outputs.core_faulted = soc_.faulted();
  outputs.core_exit_code = soc_.exit_code();
  outputs.energy_total_j = energy.total_j();
  const auto uncalibrated_j = energy.total_j() / chip_.energy.scale;
  outputs.energy_total_least_j = soc_.energy_checks().least * uncalibrated_j;
  outputs.energy_total_most_j = soc_.energy_checks().most * uncalibrated_j;
  for (std::size_t i = 0; i < kParts; ++i) outputs.energy_j[i] = energy.by_part_j[i];
  outputs.energy_core_active_j = energy.core_active_j();
  outputs.energy_memory_j = energy.memory_j();
  if (const auto* cluster = soc_.cluster()) {
    const auto sums = cluster->counters();
    outputs.cluster_instructions = static_cast<double>(sums.instructions);
    outputs.cluster_cycles = static_cast<double>(sums.cycles);
    for (unsigned core = 0; core < cluster->cores(); ++core) {
      outputs.cluster_core_cycles[core] = static_cast<double>(cluster->hart(core).counters().cycles);
    }
    outputs.cluster_powered = cluster->powered();
  }
  write_decisions();
  fields_.write(step_s);
}

void Model::write_decisions() {
  auto& outputs = variables_.outputs;
  const auto& decisions = soc_.decisions();
  const auto count = static_cast<double>(decisions.count());
  const auto seconds = [](Picoseconds time) { return static_cast<double>(time) * kPicosecond; };
  const auto mean = [&](Picoseconds sum) { return count == 0 ? 0 : seconds(sum) / count; };
  outputs.decision_count = static_cast<std::int32_t>(decisions.count());
  for (std::size_t i = 0; i < kDecisionParts; ++i) {
    outputs.decision_s[i] = seconds(decisions.last().parts[i]);
    outputs.decision_mean_s[i] = mean(decisions.sum().parts[i]);
  }
  outputs.decision_latency_s = seconds(decisions.last().latency);
  outputs.decision_mean_latency_s = mean(decisions.sum().latency);
  outputs.decision_longest_s = seconds(decisions.longest());
  for (std::size_t i = 0; i < kMostHarts; ++i) outputs.decision_mean_awake_s[i] = mean(decisions.sum().awake[i]);
}

void Model::visit(state::Visitor& v) {
  v("origin_ns", origin_ns_);
  v("soc", soc_);
  if (!v.restores()) return;
  if (past_) past_->clear();
  if (session_) session_->restored();
}

}  // namespace mebots::soc
