// SPDX-License-Identifier: Apache-2.0
#include "observe/power_formats.hpp"

#include <map>
#include <string_view>

namespace mebots::soc::observe {
namespace {

struct Call {
  std::uint64_t count = 0;
  Cost inclusive;
};

struct Function {
  Cost self;
  std::map<std::uint32_t, Call> calls;  // indexed by the number of the called place
};

void put_cost(TextFile& file, const Cost& cost) {
  file.print("{} {} {} {}\n", cost.cycles, cost.instructions, cost.time_ps, cost.energy_fj);
}

/// Writes the costs of one hart. Names are written in full in each part of the file, because viewers do not keep names
/// from part to part.
void write_part(const HartTree& hart, std::size_t part, const Functions& functions, const std::string& program,
                TextFile& file) {
  const auto& nodes = hart.tree->nodes();
  const auto inclusive = hart.tree->inclusive();
  std::map<std::uint32_t, Function> places;
  for (std::uint32_t i = 1; i < nodes.size(); ++i) {
    const auto& node = nodes[i];
    places[node.place].self += node.self;
    if (node.parent == CallTree::kRoot) continue;
    auto& call = places[nodes[node.parent].place].calls[node.place];
    call.count += node.calls;
    call.inclusive += inclusive[i];
  }
  file.print("\ncmd: {}\npart: {}\nthread: {}\n", program, part, hart.number + 1);
  file.print("desc: Hart: {}\npositions: line\n", hart.name.empty() ? "fabric controller" : hart.name);
  file.put(
      "event: Cycles : active core cycles\nevent: Instructions : retired instructions\n"
      "event: Time_ps : time with sleep [ps]\nevent: Energy_fJ : energy [fJ]\n"
      "events: Cycles Instructions Time_ps Energy_fJ\nsummary: ");
  put_cost(file, inclusive[CallTree::kRoot]);
  const auto name = [&](std::string_view key, std::uint32_t place) {
    file.print("{}=({}) {}\n", key, place + 1, functions.name(place));
  };
  for (const auto& [place, function] : places) {
    file.print("\nfl=(1) {}\n", program);
    name("fn", place);
    file.put("0 ");
    put_cost(file, function.self);
    for (const auto& [callee, call] : function.calls) {
      name("cfn", callee);
      file.print("calls={} 0\n0 ", call.count);
      put_cost(file, call.inclusive);
    }
  }
  file.put("\ntotals: ");
  put_cost(file, inclusive[CallTree::kRoot]);
}

}  // namespace

void write_callgrind(std::span<const HartTree> harts, const Functions& functions, const std::string& program,
                     TextFile& file) {
  file.put("# callgrind format\nversion: 1\ncreator: mebots-soc\n");
  for (std::size_t i = 0; i < harts.size(); ++i) write_part(harts[i], i + 1, functions, program, file);
}

}  // namespace mebots::soc::observe
