// SPDX-License-Identifier: Apache-2.0
#include "observe/coverage.hpp"

#include "mebots/error.hpp"
#include "runs/hart.hpp"

#include <algorithm>
#include <map>
#include <vector>

namespace mebots::soc::observe {

/// Stores the counts of a source file. Source of the file format: geninfo(1) of LCOV 1.16, "TRACEFILE FORMAT".
struct Coverage::File {
  struct Branch {
    std::uint32_t line = 0;
    Count count;
  };
  std::map<std::uint32_t, std::uint64_t> lines;
  std::map<std::string, std::pair<std::uint32_t, std::uint64_t>> functions;  // maps a name to a line and a count
  std::map<std::uint32_t, Branch> branches;                                  // indexed by address
};

Coverage::Coverage(const std::string& option, const std::string& path, const Elf& program)
    : program_(program), file_(option, path) {
  if (program.line_ranges().empty()) {
    throw Error(fmt::format("{} {}: {} has no line numbers: compile with -g", option, path, program.origin()));
  }
}

Coverage::Count& Coverage::at(std::uint32_t pc) {
  const auto page = pc >> kPageBits;
  if (page != recent_page_) {
    auto& found = pages_[page];
    if (found == nullptr) found = std::make_unique<Page>();
    recent_ = found.get();
    recent_page_ = page;
  }
  return (*recent_)[(pc & ((1U << kPageBits) - 1)) / 2];
}

Coverage::Count Coverage::of(std::uint32_t pc) const {
  const auto found = pages_.find(pc >> kPageBits);
  return found == pages_.end() ? Count{} : (*found->second)[(pc & ((1U << kPageBits) - 1)) / 2];
}

void Coverage::count(const Hart& hart, const Retired& instruction) {
  auto& count = at(instruction.pc);
  ++count.executed;
  if (!is_branch(instruction.decoded.op)) return;
  count.branch = true;
  if (hart.pc() != instruction.pc + instruction.decoded.length) ++count.taken;
}

void Coverage::finish() {
  std::map<std::string, File> files;
  const auto& segments = program_.segments();
  for (const auto& range : program_.line_ranges()) {
    const auto segment = std::ranges::find_if(
        segments, [&](const auto& loaded) { return range.begin - loaded.run_address < loaded.size; });
    if (range.line == 0 || segment == segments.end()) continue;
    auto& file = files[range.file];
    auto& line = file.lines[range.line];
    line = std::max(line, of(range.begin).executed);
    // In a damaged table, a range may end beyond all code, up to the last address.
    const auto size = std::min(range.end - range.begin, segment->size - (range.begin - segment->run_address));
    for (std::uint64_t offset = 0; offset < size; offset += 2) {
      const auto pc = range.begin + static_cast<std::uint32_t>(offset);
      if (const auto count = of(pc); count.branch) file.branches[pc] = {range.line, count};
    }
    const auto* symbol = program_.covering(range.begin);
    if (symbol == nullptr || !symbol->function || symbol->address != range.begin) continue;
    file.functions[symbol->shown()] = {range.line, of(range.begin).executed};
  }
  for (const auto& [path, file] : files) write(path, file);
  file_.close();
}

void Coverage::write(const std::string& path, const File& file) {
  const auto is_hit = [](const auto& entry) { return entry.second != 0; };
  file_.print("TN:\nSF:{}\n", path);
  std::size_t hit = 0;
  for (const auto& [name, at] : file.functions) {
    file_.print("FN:{0},{1}\nFNDA:{2},{1}\n", at.first, name, at.second);
    if (at.second != 0) ++hit;
  }
  file_.print("FNF:{}\nFNH:{}\n", file.functions.size(), hit);
  hit = 0;
  std::map<std::uint32_t, unsigned> blocks;  // number of blocks, by line
  for (const auto& [pc, branch] : file.branches) {
    const auto block = blocks[branch.line]++;
    const std::array<std::uint64_t, 2> ways{branch.count.taken, branch.count.executed - branch.count.taken};
    for (std::size_t way = 0; way < ways.size(); ++way) {
      file_.print("BRDA:{},{},{},{}\n", branch.line, block, way, ways[way]);
      if (ways[way] != 0) ++hit;
    }
  }
  file_.print("BRF:{}\nBRH:{}\n", 2 * file.branches.size(), hit);
  for (const auto& [line, count] : file.lines) file_.print("DA:{},{}\n", line, count);
  file_.print("LF:{}\nLH:{}\nend_of_record\n", file.lines.size(), std::ranges::count_if(file.lines, is_hit));
}

}  // namespace mebots::soc::observe
