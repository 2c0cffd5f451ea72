// SPDX-License-Identifier: Apache-2.0
#include "board/board_file.hpp"

#include "board/readers.hpp"
#include "cluster/event_unit.hpp"
#include "memory/banks.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <system_error>
#include <utility>

namespace mebots::soc {
namespace {

using data::Node;
using data::Object;

auto read_place() {
  return data::word_of<Place>({{"fabric_controller", Place::fabric_controller}, {"cluster", Place::cluster}});
}

constexpr std::uint32_t kMostLatencyCycles = 1000;
constexpr std::uint32_t kMostPmpEntries = 16;

void set_isa(BoardDescription& board, std::string_view text) {
  board.isa = read_isa(text);
  board.pmp_entries = board.isa.has(Extension::user) ? kMostPmpEntries : 0;
}

BoardLatency read_latency(const Node& node) {
  Object object(node);
  BoardLatency latency;
  object.read("fabric_controller", latency.fabric_controller, count_up_to(kMostLatencyCycles));
  object.read("cluster", latency.cluster, count_up_to(kMostLatencyCycles));
  object.read("soc", latency.soc, count_up_to(kMostLatencyCycles));
  object.comment("text");
  object.finish();
  return latency;
}

BoardMemory read_memory(const Node& node, std::set<std::string>& names) {
  Object object(node);
  BoardMemory memory;
  object.read("name", memory.name, new_name(names));
  object.read("base", memory.base, &read_address);
  object.read("size", memory.size, &read_bytes);
  object.read_if("place", memory.place, read_place());
  object.read_if("banks", memory.banks, power_of_two(1, Banks::kMost));
  object.visit_if("arbitration_tree", [&](const Node& member) {
    memory.arbitration_tree = member.flag();
    if (memory.arbitration_tree && memory.place != Place::cluster) {
      member.fail(ErrorCode::invalid_value, "only the cluster's own memory can have this key; remove the key");
    }
  });
  object.visit_if("quantum", [&](const Node& member) {
    memory.quantum = static_cast<std::uint32_t>(member.whole_number(1, Banks::kLongestRun));
    if (memory.place != Place::cluster) {
      member.fail(ErrorCode::invalid_value, "only the cluster's own memory can have this key; remove the key");
    }
  });
  object.read_if("leaks", memory.leaks, &Node::flag);
  object.read_if("alias", memory.alias, &read_address);
  object.visit_if("way", [&](const Node& member) {
    memory.latency = read_latency(member);
    if (memory.place == Place::cluster) {
      member.fail(ErrorCode::invalid_value, "the cluster's memory has no 'way': remove the key, or change 'place'");
    }
  });
  object.read_if("text", memory.text, &Node::text);
  object.finish();
  return memory;
}

constexpr std::uint32_t kMostCacheBytes = 1U << 20;
constexpr std::uint32_t kMostRefillCycles = 10'000;

void read_instruction_cache(const Node& node, BoardInstructionCaches& caches) {
  Object object(node);
  Place place = Place::fabric_controller;
  InstructionCacheSettings cache;
  object.read("place", place, read_place());
  object.read("line", cache.line, power_of_two(4, 1024));
  object.read("ways", cache.ways, power_of_two(1, 64));
  object.read("size", cache.size, power_of_two(object.sound() ? cache.line * cache.ways : 1, kMostCacheBytes));
  object.read("refill_cycles", cache.refill_cycles, count_up_to(kMostRefillCycles));
  object.read_if("refill_soc_cycles", cache.refill_soc_cycles, count_up_to(kMostRefillCycles));
  object.read_if("invalid_ways_first", cache.invalid_ways_first, &Node::flag);
  object.comment("text");
  object.finish();
  if (!object.sound()) return;
  if (place == Place::fabric_controller && object.has("refill_soc_cycles")) {
    node.at("refill_soc_cycles")
        .fail(ErrorCode::invalid_value,
              "the fabric controller has the clock of the SoC: add these cycles to refill_cycles");
  }
  if (place == Place::fabric_controller && cache.invalid_ways_first) {
    node.at("invalid_ways_first")
        .fail(ErrorCode::invalid_value, "only the cluster's cache can have this key; remove the key");
  }
  auto& taken = caches[static_cast<std::size_t>(place)];
  if (taken.size != 0) {
    node.at("place").fail(ErrorCode::duplicate_name, "this place has an instruction cache already");
  }
  taken = cache;
}

struct Span {
  std::string name;
  std::uint64_t base;
  std::uint64_t size;
};

void check_overlaps(const Node& root, const BoardDescription& board) {
  std::vector<Span> taken;
  const auto take = [&](const Node& node, const Span& span) {
    if (span.base + span.size > 0x1'0000'0000ULL) {
      node.complain(ErrorCode::value_out_of_range,
                    fmt::format("{} passes the end of the 32-bit address space", span.name));
    }
    for (const auto& other : taken) {
      if (span.base < other.base + other.size && other.base < span.base + span.size) {
        node.complain(ErrorCode::invalid_value,
                      fmt::format("{} (0x{:08x} to 0x{:08x}) overlaps {} at 0x{:08x}", span.name, span.base,
                                  span.base + span.size - 1, other.name, other.base));
      }
    }
    taken.push_back(span);
  };
  const auto memories = root.at("memories").elements();
  for (std::size_t i = 0; i < board.memories.size(); ++i) {
    const auto& memory = board.memories[i];
    take(memories[i], {memory.name, memory.base, memory.size});
    // Only cores in the memory's location see its alias. Therefore the other cores may have another memory at the same
    // address.
    if (memory.alias && memory.place == Place::fabric_controller) {
      take(memories[i], {memory.name, *memory.alias, memory.size});
    }
  }
  const auto devices = root.at("devices").elements();
  for (std::size_t i = 0; i < board.devices.size(); ++i) {
    const auto& device = board.devices[i];
    if (!device.is_on_bus()) continue;
    take(devices[i], {device.name, device.base, device.size()});
    for (const auto address : device.also_at) take(devices[i], {device.name, address, device.size()});
  }
}

/// Reports interrupt lines that two devices share, because firmware could not determine the device that raised the
/// interrupt. Also reports an interrupt controller that is not a device of the board.
void check_interrupts(const Node& root, const BoardDescription& board) {
  std::map<std::pair<std::string, int>, std::string> taken;
  std::vector<std::string> names;
  for (const auto& device : board.devices) names.push_back(device.name);
  const auto devices = root.at("devices").elements();
  for (std::size_t i = 0; i < board.devices.size(); ++i) {
    const auto& device = board.devices[i];
    const auto& controller = device.interrupt_controller;
    if (!controller.empty() && std::ranges::find(names, controller) == names.end()) {
      devices[i].at("interrupt_controller").complain_unknown("the device", controller, names);
    }
    if (device.interrupt < 0) continue;
    const auto [other, is_new] = taken.emplace(std::pair(controller, device.interrupt), device.name);
    if (is_new) continue;
    devices[i]
        .at("interrupt")
        .complain(ErrorCode::duplicate_name, fmt::format("{} and {} use the same interrupt {}; give each its own line",
                                                         other->second, device.name, device.interrupt));
  }
}

/// Checks that parts are attached to devices. Also checks that a regulator's loads are listed before the regulator, so
/// that no regulator supplies itself. Names of connection points are checked by the devices.
void check_parts(const Node& root, const BoardDescription& board) {
  const auto entries = root.at("devices").elements();
  std::vector<std::string> on_bus;
  for (const auto& device : board.devices) {
    if (device.is_on_bus()) on_bus.push_back(device.name);
  }
  std::vector<std::string> loads{std::string(kChipLoad)};
  std::set<std::string> supplied;
  for (std::size_t i = 0; i < board.devices.size(); ++i) {
    const auto& device = board.devices[i];
    if (device.part && !device.part->attached_to.empty()) {
      const auto owner = device.part->attached_to.substr(0, device.part->attached_to.find('.'));
      if (std::ranges::find(on_bus, owner) == on_bus.end()) {
        entries[i].at("part").at("attached_to").complain_unknown("the device", owner, on_bus);
      }
    }
    if (device.regulator) {
      const auto nodes = entries[i].at("regulator").at("loads").elements();
      for (std::size_t k = 0; k < device.regulator->loads.size(); ++k) {
        const auto& load = device.regulator->loads[k];
        if (std::ranges::find(loads, load) == loads.end()) {
          nodes[k].complain_unknown("the part or regulator before this one", load, loads);
        } else if (!supplied.insert(load).second) {
          nodes[k].complain(ErrorCode::duplicate_name, fmt::format("{} already has a regulator", load));
        }
      }
    }
    if (!device.is_on_bus()) loads.push_back(device.name);
  }
}

BoardAbsence read_absence(const Node& node) {
  Object object(node);
  BoardAbsence absence;
  object.read("name", absence.name, &Node::readable_text);
  object.read("base", absence.base, &read_address);
  object.read("size", absence.size, &read_bytes);
  object.read_if("text", absence.text, &Node::text);
  object.finish();
  return absence;
}

BoardSupply read_supply(const Node& node, const BoardDescription& board) {
  Object object(node);
  BoardSupply supply;
  object.read("voltage", supply.variable, [&](const Node& member) {
    auto name = member.text();
    std::vector<std::string> known;
    for (const auto& device : board.devices) {
      for (const auto& variable : device.variables) {
        if (variable.causality == BoardVariable::Causality::input && variable.type == "Real") {
          known.push_back(variable.name);
        }
      }
    }
    if (std::ranges::find(known, name) == known.end()) member.fail_unknown("the Real input", name, known);
    return name;
  });
  object.read("least", supply.least_v, data::number(data::Limits::positive()));
  object.comment("text");
  object.finish();
  return supply;
}

/// Reads the name of the sender of set-points: a device, or a peripheral of the uDMA with a variable that counts
/// transactions.
std::string read_decisions(const Node& node, const BoardDescription& board) {
  Object object(node);
  std::string sender;
  object.read("end_with", sender, [&](const Node& member) {
    auto name = member.text();
    std::vector<std::string> known;
    constexpr std::string_view kCounted = ".transactions";
    for (const auto& device : board.devices) {
      if (std::ranges::any_of(device.registers, [](const BoardRegister& reg) { return !reg.sends.empty(); })) {
        known.push_back(device.name);
      }
      for (const auto& variable : device.variables) {
        if (variable.name.ends_with(kCounted)) {
          known.push_back(variable.name.substr(0, variable.name.size() - kCounted.size()));
        }
      }
    }
    if (std::ranges::find(known, name) == known.end()) member.fail_unknown("the sender of set-points", name, known);
    return name;
  });
  object.comment("text");
  object.finish();
  return sender;
}

/// Reads a file name without folders, so that a board can be moved together with its libraries.
std::string read_file_name(const Node& node) {
  auto name = node.readable_text();
  if (name.find('/') != std::string::npos || name == "." || name == "..") {
    node.fail(ErrorCode::invalid_value,
              fmt::format("\"{}\" must be a file name without a folder. The folder of the library is that of the board "
                          "file, or one given with --devices",
                          name));
  }
  return name;
}

/// Calls `set()`. If the function throws Error, reports the error with the node's place in the file.
template <typename Set>
void set_from(const Node& node, Set set) {
  try {
    set();
  } catch (const Error& error) {
    node.fail(ErrorCode::invalid_value, error.what());
  }
}

void read_core(Object& object, BoardDescription& board) {
  object.visit_if("core", [&](const Node& member) {
    const auto name = member.text();
    set_from(member, [&] { set_core(board, name); });
  });
  object.visit_if("isa", [&](const Node& member) {
    const auto text = member.text();
    if (board.core.starts_with("rv32")) {
      member.fail(ErrorCode::invalid_value, "the core's name is an instruction set already: leave isa out");
    }
    set_from(member, [&] { set_isa(board, text); });
  });
  object.read_if("pmp_entries", board.pmp_entries, count_up_to(kMostPmpEntries));
}

BoardDescription read_root(const Node& root) {
  const auto chip = data::word_of<std::string>({{"gap8", "gap8"}});
  const auto energy = data::word_of<std::string>({{"gap8", "gap8"}, {"gap8_silicon", "gap8_silicon"}});
  Object object(root);
  BoardDescription board;
  std::set<std::string> names;
  object.comment("$schema");
  object.read("name", board.name, &read_name);
  object.read_if("text", board.text, &Node::text);
  object.read_if("chip", board.chip, chip);
  object.read_if("energy", board.energy, energy);
  read_core(object, board);
  object.read_if("hart_id", board.hart_id, count_up_to(std::numeric_limits<std::uint32_t>::max()));
  object.read_if("cluster_cores", board.cluster_cores, count_up_to(kMostClusterCores));
  if (board.cluster_cores != 0 && (board.isa != Extensions() || board.pmp_entries != 0)) {
    root.at("cluster_cores")
        .complain(ErrorCode::invalid_value,
                  "a board with a cluster has no options of its core: leave out isa and pmp_entries, or cluster_cores");
  }
  const bool has_memories = object.read("memories", board.memories,
                                        data::list_of([&](const Node& node) { return read_memory(node, names); }));
  if (has_memories && board.memories.empty()) {
    root.at("memories").complain(ErrorCode::invalid_value, "the list is empty: a program needs RAM");
  }
  object.visit_if("instruction_caches", [&](const Node& member) {
    for (const auto& entry : member.elements()) {
      entry.attempt([&] { read_instruction_cache(entry, board.instruction_caches); });
    }
  });
  const bool has_way =
      std::ranges::any_of(board.memories, [](const BoardMemory& memory) { return memory.latency.has_value(); });
  if (object.sound() && board.instruction_cache(Place::cluster).refill_soc_cycles != 0 && !has_way) {
    root.at("instruction_caches")
        .complain(ErrorCode::invalid_value, "refill_soc_cycles needs a memory with a 'way', and none has one");
  }
  const bool has_devices =
      object.read("devices", board.devices, data::list_of([&](const Node& node) { return read_device(node, names); }));
  object.read_if("absent", board.absent, data::list_of(&read_absence));
  object.visit_if("supply", [&](const Node& member) { board.supply = read_supply(member, board); });
  object.visit_if("decisions", [&](const Node& member) { board.decisions_end_with = read_decisions(member, board); });
  object.read_if("libraries", board.libraries, data::list_of(&read_file_name));
  object.finish();
  if (has_devices) check_interrupts(root, board);
  if (has_devices) check_parts(root, board);
  if (has_memories && has_devices) check_overlaps(root, board);
  return board;
}

}  // namespace

BoardDescription read_board(const std::filesystem::path& path) {
  auto board = data::Document(path).read(&read_root);
  board.folder = path.parent_path();
  return board;
}

BoardDescription parse_board(std::string_view text, const std::string& name) {
  return data::Document(text, name).read(&read_root);
}

void set_core(BoardDescription& board, const std::string& name) {
  if (name.starts_with("rv")) {
    set_isa(board, name);
  } else if (name != "ri5cy" && name != "cv32e40p") {
    throw Error(ErrorCode::invalid_value,
                fmt::format("no core is named \"{}\"; there are ri5cy, cv32e40p, rv32imc, and rv32imc with further "
                            "extensions such as rv32imac_zba_zbb",
                            name));
  }
  board.core = name;
}

std::string_view other_chip_of(std::string_view elf_bytes) {
  // Folders with the headers of the SDKs. The names are long enough not to occur by chance.
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kFolders{{
      {"pmsis/chips/gap9", "GAP9"},
      {"vendors/gwt/gap9", "GAP9"},
      {"install/GAP9/include", "GAP9"},
      {"archi/chips/wolfe", "Mr. Wolf"},
  }};
  for (const auto& [folder, chip] : kFolders) {
    if (elf_bytes.find(folder) != std::string_view::npos) return chip;
  }
  return {};
}

void require_own_chip(const std::filesystem::path& program, const BoardDescription& board) {
  if (std::ranges::find(board.devices, "gap8_event_unit", &BoardDevice::kind) == board.devices.end()) return;
  std::error_code error;
  std::ifstream file(program, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(program, error)) return;
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  if (const auto chip = other_chip_of(bytes); !chip.empty()) {
    throw Error(fmt::format("{}: this program is for {}; board {} is a GAP8: use a build of this program for GAP8",
                            program.string(), chip, board.name));
  }
}

}  // namespace mebots::soc
