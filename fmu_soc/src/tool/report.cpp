// SPDX-License-Identifier: Apache-2.0
#include "tool/report.hpp"

#include "energy/meter.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

namespace mebots::soc::tool {
namespace {

using Json = nlohmann::ordered_json;

/// Descriptions of the parts, in the order of kPartNames.
constexpr std::array<std::string_view, kParts> kPartTexts{
    "instructions of the fabric controller, and its gated clock while it sleeps",
    "instructions of the cluster's cores, and their gated clocks while they sleep",
    "accesses to the fabric controller's own memory",
    "accesses to L2",
    "accesses to L1, the cluster's memory",
    "words between cluster and SoC, accesses to devices",
    "the DMA: data moved, and its clock while the cluster is on",
    "clock tree, buses and peripherals of the fabric controller, in proportion to the clock",
    "clock tree and buses of the cluster while it is on",
    "leakage of all parts that have supply voltage",
    "memories kept in retention sleep"};
constexpr double kPicosecond = 1e-12;
constexpr int kDigits = 4;

struct Prefix {
  double size;
  std::string_view text;
};
constexpr std::array<Prefix, 6> kPrefixes = {
    {{1, ""}, {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}, {1e-12, "p"}, {1e-15, "f"}}};

/// Returns a number with four significant digits, such as 2.475, 184.1 or 1000.
std::string number_text(double value) {
  if (value == 0) return "0";
  const int before_point = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  return fmt::format("{:.{}f}", value, std::max(0, kDigits - std::max(before_point, 1)));
}

/// Returns a quantity with an SI prefix, such as 184.1 mW.
std::string quantity_text(double value, std::string_view unit) {
  if (value == 0) return fmt::format("0 {}", unit);
  // A value that rounds to 1000 uses the next larger prefix.
  const auto fits = [&](const Prefix& prefix) { return std::abs(value) >= prefix.size * 0.99995; };
  const auto* found = std::ranges::find_if(kPrefixes, fits);
  const auto& prefix = found == kPrefixes.end() ? kPrefixes.back() : *found;
  return fmt::format("{} {}{}", number_text(value / prefix.size), prefix.text, unit);
}

using Row = std::vector<std::string>;

/// Prints a table. Columns with `left` are aligned to the left, all others to the right.
void print_table(const std::vector<Row>& rows, const std::vector<bool>& left) {
  std::vector<std::size_t> widths(left.size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const auto* gap = i == 0 ? "" : "  ";
      line +=
          left[i] ? fmt::format("{}{:<{}}", gap, row[i], widths[i]) : fmt::format("{}{:>{}}", gap, row[i], widths[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
  }
}

}  // namespace

ChipReport report_of(const Soc& soc, double host_mips, std::optional<std::uint32_t> tohost) {
  ChipReport report;
  const auto& counters = soc.hart().counters();
  const auto add = [&](std::string name, unsigned cores, const auto& counts, const InstructionCache* cache) {
    report.cores.push_back({std::move(name), cores, counts.instructions, counts.cycles, {}, counts.fetch_cycles});
    if (cache != nullptr) report.cores.back().refills = cache->refills();
  };
  const auto* cluster = soc.cluster();
  add(cluster == nullptr ? "core" : "fabric controller", 1, counters, soc.instruction_cache());
  if (cluster != nullptr) add("cluster", cluster->cores(), cluster->counters(), cluster->instruction_cache());

  report.time_s = static_cast<double>(soc.now()) * kPicosecond;
  report.asleep_s = static_cast<double>(soc.sleep_time()) * kPicosecond;
  const auto energy = soc.energy();
  report.chip_j = energy.total_j();
  const auto components = energy.components();
  for (std::size_t i = 0; i < components.size(); ++i) {
    report.parts.push_back({std::string(components[i].name), components[i].energy_j, std::string(kPartTexts[i])});
  }
  const auto& checks = soc.energy_checks();
  report.checks = checks.count;
  report.least_j = checks.least * report.chip_j;
  report.most_j = checks.most * report.chip_j;
  for (const auto& slot : soc.devices()) {
    const auto& entry = *slot.entry;
    if (entry.states.empty() && entry.is_on_bus()) continue;
    auto text = entry.text;
    if (entry.regulator) {
      text += fmt::format(": {}", fmt::join(entry.regulator->loads, " + "));
      if (entry.regulator->efficiency != 1) text += fmt::format(", efficiency {:g}", entry.regulator->efficiency);
    }
    report.devices.push_back({entry.name, soc.power().energy_j(*slot.device), text});
  }
  report.host_mips = host_mips;
  report.tohost = tohost;
  if (soc.end() == End::exited) report.exit_code = soc.exit_code();
  return report;
}

namespace {

double cycles_per_instruction(const ChipReport::Cores& cores) {
  return static_cast<double>(cores.cycles) / static_cast<double>(cores.instructions);
}

void print_counts(const ChipReport& report) {
  std::vector<Row> rows = {{""}, {"instructions"}, {"cycles"}, {"CPI"}, {"cache refills"}, {"cycles waited"}};
  for (const auto& cores : report.cores) {
    rows[0].push_back(cores.cores == 1 ? cores.name : fmt::format("{}, {} cores", cores.name, cores.cores));
    rows[1].push_back(std::to_string(cores.instructions));
    rows[2].push_back(std::to_string(cores.cycles));
    rows[3].push_back(cores.instructions == 0 ? "-" : fmt::format("{:.3f}", cycles_per_instruction(cores)));
    rows[4].push_back(cores.refills ? std::to_string(*cores.refills) : "-");
    rows[5].push_back(cores.refills ? std::to_string(cores.waited_cycles) : "-");
  }
  const bool has_cache = std::ranges::any_of(report.cores, [](const auto& cores) { return cores.refills.has_value(); });
  if (!has_cache) rows.resize(4);
  if (report.cores.size() == 1) rows.erase(rows.begin());
  std::vector<bool> left(report.cores.size() + 1, false);
  left[0] = true;
  print_table(rows, left);
}

Row energy_row(const ChipReport::Part& part, const ChipReport& report, bool has_share) {
  const auto mean = report.time_s > 0 ? quantity_text(part.energy_j / report.time_s, "W") : "-";
  const auto share =
      has_share && report.chip_j > 0 ? fmt::format("{:.1f} %", 100 * part.energy_j / report.chip_j) : std::string();
  return {part.name, quantity_text(part.energy_j, "J"), mean, share, part.text};
}

/// Prints the energies of the parts in descending order, their sum, and the energies of the board's devices. Parts and
/// devices without energy are only listed by name.
void print_energy(const ChipReport& report) {
  std::vector<Row> rows = {{"part", "energy", "mean power", "share", ""}};
  auto parts = report.parts;
  std::ranges::stable_sort(parts, std::greater(), &ChipReport::Part::energy_j);
  std::vector<std::string> unused;
  const auto add = [&](const ChipReport::Part& part, bool has_share) {
    if (part.energy_j == 0) {
      unused.push_back(part.name);
    } else {
      rows.push_back(energy_row(part, report, has_share));
    }
  };
  for (const auto& part : parts) add(part, true);
  auto chip = energy_row({"chip", report.chip_j, "the parts above"}, report, true);
  chip.back() += fmt::format("; range by {} checks: {} to {} (not a confidence interval)", report.checks,
                             quantity_text(report.least_j, "J"), quantity_text(report.most_j, "J"));
  rows.push_back(std::move(chip));
  for (const auto& device : report.devices) add(device, false);
  print_table(rows, {true, false, false, false, true});
  if (!unused.empty()) fmt::print("no energy: {}\n", fmt::join(unused, ", "));
}

Json json_of(const std::vector<ChipReport::Part>& parts) {
  Json found = Json::object();
  for (const auto& part : parts) found[part.name] = part.energy_j;
  return found;
}

}  // namespace

void print(const ChipReport& report) {
  print_counts(report);
  const auto asleep = report.time_s > 0 ? 100 * report.asleep_s / report.time_s : 0;
  fmt::print("time {}, asleep for {} ({:.1f} %)\n\n", quantity_text(report.time_s, "s"),
             quantity_text(report.asleep_s, "s"), asleep);
  print_energy(report);
  fmt::print("\nhost {:.1f} MIPS\n", report.host_mips);
  if (report.tohost) fmt::print("tohost {}\n", *report.tohost);
  if (report.exit_code) fmt::print("exit {}\n", *report.exit_code);
}

namespace {

Json json_of(const ChipReport& report) {
  Json json;
  for (const auto& cores : report.cores) {
    auto& found = json[cores.cores == 1 ? "controller" : "cluster"];
    found = {{"cores", cores.cores}, {"instructions", cores.instructions}, {"cycles", cores.cycles}};
    if (cores.refills) {
      found["cache_refills"] = *cores.refills;
      found["cycles_waited"] = cores.waited_cycles;
    }
  }
  json["time_s"] = report.time_s;
  json["asleep_s"] = report.asleep_s;
  json["chip_j"] = report.chip_j;
  json["chip_mean_w"] = report.time_s > 0 ? Json(report.chip_j / report.time_s) : Json();
  json["checks"] = {{"count", report.checks}, {"least_j", report.least_j}, {"most_j", report.most_j}};
  json["parts_j"] = json_of(report.parts);
  json["devices_j"] = json_of(report.devices);
  json["host_mips"] = report.host_mips;
  json["tohost"] = report.tohost ? Json(*report.tohost) : Json();
  json["exit_code"] = report.exit_code ? Json(*report.exit_code) : Json();
  return json;
}

Json json_of(const observe::StackCost& cost) {
  Json causes = Json::object();
  for (std::size_t i = 0; i < kCycleCauses; ++i) {
    if (cost.causes[i] != 0) causes[std::string(kCycleCauseNames[i])] = cost.causes[i];
  }
  return {{"cycles", cost.cycles()},
          {"instructions", cost.instructions},
          {"asleep_s", static_cast<double>(cost.asleep) * kPicosecond},
          {"causes", std::move(causes)}};
}

/// Returns the cycles of each function as JSON, in descending order.
Json json_of(const observe::CoreStack& core, const observe::Functions& names) {
  auto json = json_of(core.total());
  std::vector<std::pair<std::uint32_t, observe::StackCost>> functions(core.functions().begin(), core.functions().end());
  std::ranges::stable_sort(functions, std::greater(), [](const auto& entry) { return entry.second.cycles(); });
  json["functions"] = Json::array();
  for (const auto& [place, cost] : functions) {
    Json function = {{"name", names.name(place)}};
    function.update(json_of(cost));
    json["functions"].push_back(std::move(function));
  }
  return json;
}

}  // namespace

std::string json_text(const ChipReport& report) {
  return json_of(report).dump(2) + "\n";
}

std::string json_text(const ChipReport& report, const observe::CycleStack& cycles) {
  auto json = json_of(report);
  json["harts"] = Json::array();
  for (const auto& core : cycles.harts()) {
    if (core.total().instructions == 0) continue;
    Json hart = {{"hart", core.number()}};
    hart.update(json_of(core, cycles.functions()));
    json["harts"].push_back(std::move(hart));
  }
  json["banks"] = Json::array();
  for (const auto& bank : cycles.banks()) {
    json["banks"].push_back(
        {{"accesses", bank.accesses}, {"conflicts", bank.conflicts}, {"conflict_cycles", bank.conflict_cycles}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mebots::soc::tool
