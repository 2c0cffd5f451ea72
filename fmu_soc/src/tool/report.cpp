// SPDX-License-Identifier: Apache-2.0
#include "tool/run.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <string_view>
#include <utility>

namespace mebots::soc::tool {

void print_report(const Soc& soc, double host_s, std::optional<std::uint32_t> tohost) {
  const auto& counters = soc.hart().counters();
  const auto energy = soc.energy();
  fmt::print("instructions {}\n", counters.instructions);
  fmt::print("cycles {}\n", counters.cycles);
  if (const auto* cluster = soc.cluster()) {
    const auto sums = cluster->counters();
    fmt::print("cluster instructions {}, cycles {} of {} cores together\n", sums.instructions, sums.cycles,
               cluster->cores());
  }
  const auto print_cache = [](std::string_view owner, const InstructionCache* cache, std::uint64_t cycles) {
    if (cache == nullptr) return;
    fmt::print("{} instruction cache refills {}, cycles waited {}\n", owner, cache->refills(), cycles);
  };
  print_cache("fabric controller's", soc.instruction_cache(), counters.fetch_cycles);
  if (const auto* cluster = soc.cluster()) {
    print_cache("cluster's", cluster->instruction_cache(), cluster->counters().fetch_cycles);
  }
  fmt::print("time {:.9g} s, of it asleep {:.9g} s\n", static_cast<double>(soc.now()) * 1e-12,
             static_cast<double>(soc.sleep_time()) * 1e-12);
  fmt::print("energy {:.9g} J", energy.total_j());
  const char* before = ": ";
  for (const auto& component : energy.components()) {
    fmt::print("{}{} {:.9g} J", std::exchange(before, ", "), component.name, component.energy_j);
  }
  const auto& checks = soc.energy_checks();
  fmt::print("\nenergy as {} checks would have it: {:.9g} J to {:.9g} J (no confidence interval)\n", checks.count,
             checks.least * energy.total_j(), checks.most * energy.total_j());
  for (const auto& slot : soc.devices()) {
    const bool consumes = !slot.entry->states.empty() || !slot.entry->is_on_bus();
    if (consumes) fmt::print("{} {:.9g} J\n", slot.entry->name, soc.power().energy_j(*slot.device));
  }
  fmt::print("host {:.1f} MIPS\n", static_cast<double>(soc.instructions()) / host_s / 1e6);
  if (tohost) fmt::print("tohost {}\n", *tohost);
  if (soc.end() == End::exited) fmt::print("exit {}\n", soc.exit_code());
}

namespace {

std::uint32_t required_symbol(const std::string& path, const Soc& soc, std::string_view name) {
  const auto address = soc.program().symbol(name);
  if (!address) {
    throw Error(
        fmt::format("--signature {}: {} has no symbol {}; the signature is the words between begin_signature "
                    "and end_signature",
                    path, soc.program().origin(), name));
  }
  return *address;
}

std::uint32_t checked_end(const std::string& path, const Soc& soc, std::uint32_t begin) {
  const auto end = required_symbol(path, soc, "end_signature");
  if (end < begin || (end - begin) % 4 != 0) {
    throw Error(
        fmt::format("--signature {}: from begin_signature 0x{:08x} to end_signature 0x{:08x} is not a whole number "
                    "of words",
                    path, begin, end));
  }
  if (end != begin && soc.memory().find(begin, end - begin) == nullptr) {
    throw Error(fmt::format("--signature {}: no memory from 0x{:08x} to 0x{:08x}", path, begin, end));
  }
  return end;
}

}  // namespace

Signature::Signature(const std::string& path, const Soc& soc)
    : begin_(required_symbol(path, soc, "begin_signature")),
      end_(checked_end(path, soc, begin_)),
      file_("--signature", path) {}

void Signature::write(const Soc& soc) {
  for (auto address = begin_; address < end_; address += 4) {
    std::uint32_t word = 0;
    soc.memory().read(address, {reinterpret_cast<std::uint8_t*>(&word), sizeof word});
    file_.print("{:08x}\n", word);
  }
  file_.close();
}

}  // namespace mebots::soc::tool
