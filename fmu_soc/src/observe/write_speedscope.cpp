// SPDX-License-Identifier: Apache-2.0
#include "observe/power_formats.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace mebots::soc::observe {
namespace {

struct Series {
  const char* name;
  const char* unit;
  std::int64_t Cost::*part;
  int decimals;
};

/// Writes an integer with a decimal point. A double would round the value.
void put_value(TextFile& file, std::int64_t value, int decimals) {
  std::int64_t scale = 1;
  for (int i = 0; i < decimals; ++i) scale *= 10;
  const char* sign = value < 0 ? "-" : "";
  const auto size = value < 0 ? -value : value;
  if (decimals == 0) {
    file.print("{}{}", sign, size);
  } else {
    file.print("{}{}.{:0{}}", sign, size / scale, size % scale, decimals);
  }
}

class Writer {
 public:
  Writer(const CallTree& tree, TextFile& file)
      : tree_(tree), inclusive_(tree.inclusive()), children_(tree.children()), file_(file) {}

  /// `whose` is the name of the hart, or empty if there is only one hart.
  void write(const Series& series, const std::string& whose) {
    file_.print(R"({{"type":"evented","name":"{}{}{}","unit":"{}","startValue":0,"endValue":)", series.name,
                whose.empty() ? "" : ", ", whose, series.unit);
    put_value(file_, inclusive_[CallTree::kRoot].*series.part, series.decimals);
    file_.put(",\"events\":[");
    first_ = true;
    std::int64_t at = 0;
    // Visits the tree depth first with an explicit stack, because deep recursion in the program must not overflow the
    // writer's stack.
    struct Step {
      std::uint32_t node;
      std::size_t next_child;
      std::int64_t end;
    };
    std::vector<Step> path{{CallTree::kRoot, 0, 0}};
    while (!path.empty()) {
      auto& top = path.back();
      if (top.next_child < children_[top.node].size()) {
        const auto node = children_[top.node][top.next_child++];
        event('O', node, at, series);
        path.push_back({node, 0, at + inclusive_[node].*series.part});
      } else {
        if (top.node != CallTree::kRoot) {
          at = top.end;
          event('C', top.node, at, series);
        }
        path.pop_back();
      }
    }
    file_.put("]}");
  }

 private:
  void event(char type, std::uint32_t node, std::int64_t at, const Series& series) {
    file_.print("{}{{\"type\":\"{}\",\"frame\":{},\"at\":", first_ ? "\n" : ",\n", type, tree_.nodes()[node].place);
    put_value(file_, at, series.decimals);
    file_.put("}");
    first_ = false;
  }

  const CallTree& tree_;
  std::vector<Cost> inclusive_;
  std::vector<std::vector<std::uint32_t>> children_;
  TextFile& file_;
  bool first_ = true;
};

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void write_nodes(std::span<const HartTree> harts, TextFile& file) {
  for (const auto& hart : harts) {
    file.print("{}{{\"name\":{},\"nodes\":[", &hart == &harts.front() ? "" : ",\n", quoted(hart.name));
    const auto& nodes = hart.tree->nodes();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      file.print("{}{},{}", i == 0 ? "" : ",", nodes[i].parent, nodes[i].place);
    }
    file.put("]}");
  }
}

/// Writes the time windows. Leaves out cores that executed nothing, because the file contains no call trees of them.
void write_windows(std::span<const HartTree> harts, std::span<const ProfileWindows::Window> windows, TextFile& file) {
  constexpr int kPsDigits = 3;
  for (const auto& window : windows) {
    file.put(&window == &windows.front() ? "{\"from\":" : ",\n{\"from\":");
    put_value(file, window.from, kPsDigits);
    file.put(",\"to\":");
    put_value(file, window.to, kPsDigits);
    file.put(",\"parts\":[");
    bool first = true;
    for (const auto& [hart, node, self] : window.parts) {
      const auto tree = std::ranges::find(harts, hart, &HartTree::number);
      if (tree == harts.end()) continue;
      file.print("{}{},{},{},{},{}", first ? "" : ",", tree - harts.begin(), node, self.cycles, self.time_ps,
                 self.energy_fj);
      first = false;
    }
    file.put("]}");
  }
}

}  // namespace

void write_speedscope(std::span<const HartTree> harts, const Functions& functions,
                      std::span<const ProfileWindows::Window> windows, const std::string& program, TextFile& file) {
  file.print(
      "{{\"$schema\":\"https://www.speedscope.app/file-format-schema.json\",\"exporter\":\"mebots-soc\","
      "\"name\":{},\"activeProfileIndex\":0,\"shared\":{{\"frames\":[",
      quoted(program));
  for (std::uint32_t i = 0; i < functions.count(); ++i) {
    file.print("{}{{\"name\":{}}}", i == 0 ? "\n" : ",\n", quoted(functions.name(i)));
  }
  file.put("]},\"profiles\":[\n");
  for (const auto& hart : harts) {
    Writer writer(*hart.tree, file);
    if (&hart != &harts.front()) file.put(",\n");
    writer.write({"time", "nanoseconds", &Cost::time_ps, 3}, hart.name);
    file.put(",\n");
    writer.write({"energy [nJ]", "none", &Cost::energy_fj, 6}, hart.name);
    file.put(",\n");
    writer.write({"cycles", "none", &Cost::cycles, 0}, hart.name);
  }
  file.put("],\"mebots\":{\"harts\":[\n");
  write_nodes(harts, file);
  file.put("],\"windows\":[\n");
  write_windows(harts, windows, file);
  file.put("]}}\n");
}

}  // namespace mebots::soc::observe
