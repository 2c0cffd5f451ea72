// SPDX-License-Identifier: Apache-2.0
#include "observe/profile.hpp"

#include "mebots/error.hpp"
#include "observe/power_formats.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <tuple>
#include <utility>

namespace mebots::soc::observe {
namespace {

bool wants_callgrind(const std::string& option, const std::string& path) {
  const auto ending = std::filesystem::path(path).extension();
  if (ending == ".json") return false;
  if (ending == ".callgrind" || ending == ".out") return true;
  throw Error(fmt::format(
      "{} {}: the name must end in .json (for speedscope) or in .callgrind or .out (for KCachegrind)", option, path));
}

}  // namespace

Profile::Profile(const std::string& option, const std::string& path, const Soc& soc)
    : soc_(soc),
      functions_(soc.program()),
      windows_(soc.now(), soc.harts()),
      callgrind_(wants_callgrind(option, path)),
      file_(option, path) {
  for (unsigned number = 0; number < soc.harts(); ++number) harts_.emplace_back(soc, number, functions_);
}

void Profile::restored() {
  windows_.restart(soc_.now(), harts_);
  for (auto& hart : harts_) hart.restored();
}

void Profile::stepped() {
  for (auto& hart : harts_) hart.settle();
  windows_.stepped(soc_.now(), harts_);
}

void Profile::finish() {
  std::vector<HartTree> trees;
  for (auto& hart : harts_) hart.finish();
  windows_.stepped(soc_.now(), harts_);
  windows_.restart(soc_.now(), harts_);
  for (auto& hart : harts_) {
    const auto number = hart.number();
    if (number == kFabricControllerHart) {
      trees.push_back({number, "", &hart.tree()});
    } else if (hart.total().instructions != 0) {
      trees.push_back({number, fmt::format("cluster core {}", core_of_hart(number)), &hart.tree()});
    }
  }
  if (callgrind_) {
    write_callgrind(trees, functions_, soc_.program().origin(), file_);
  } else {
    write_speedscope(trees, functions_, windows_.windows(), soc_.program().origin(), file_);
  }
  file_.close();
}

namespace {

using Part = ProfileWindows::Part;
using Window = ProfileWindows::Window;

auto place_of(const Part& part) {
  return std::tuple(part.hart, part.node);
}

Window joined(const Window& a, const Window& b) {
  Window both{std::min(a.from, b.from), std::max(a.to, b.to), {}};
  both.parts.reserve(a.parts.size() + b.parts.size());
  std::ranges::merge(a.parts, b.parts, std::back_inserter(both.parts), {}, place_of, place_of);
  std::size_t kept = 0;
  for (std::size_t i = 1; i < both.parts.size(); ++i) {
    if (place_of(both.parts[kept]) == place_of(both.parts[i])) {
      both.parts[kept].self += both.parts[i].self;
    } else {
      both.parts[++kept] = both.parts[i];
    }
  }
  if (!both.parts.empty()) both.parts.resize(kept + 1);
  return both;
}

}  // namespace

void ProfileWindows::stepped(Picoseconds time, const std::deque<CoreProfile>& harts) {
  to_ = time;
  if (++steps_ >= steps_a_window_) close(harts);
}

void ProfileWindows::restart(Picoseconds time, const std::deque<CoreProfile>& harts) {
  close(harts);
  from_ = to_ = time;
}

void ProfileWindows::close(const std::deque<CoreProfile>& harts) {
  Window window{from_, to_, {}};
  for (std::uint32_t hart = 0; hart < harts.size(); ++hart) {
    const auto& nodes = harts[hart].tree().nodes();
    auto& counted = counted_[hart];
    counted.resize(nodes.size());
    for (std::uint32_t node = 0; node < nodes.size(); ++node) {
      const auto self = nodes[node].self - counted[node];
      if (self == Cost{}) continue;
      window.parts.push_back({hart, node, self});
      counted[node] = nodes[node].self;
    }
  }
  from_ = to_;
  steps_ = 0;
  if (window.parts.empty()) return;
  if (window.from == window.to && !windows_.empty()) {  // costs that are added at the end belong to the last window
    windows_.back() = joined(windows_.back(), window);
    return;
  }
  windows_.push_back(std::move(window));
  if (windows_.size() >= kMost) join_neighbours();
}

void ProfileWindows::join_neighbours() {
  std::vector<Window> fewer;
  fewer.reserve(kMost);
  for (std::size_t i = 0; i + 1 < windows_.size(); i += 2) fewer.push_back(joined(windows_[i], windows_[i + 1]));
  if (windows_.size() % 2 != 0) fewer.push_back(std::move(windows_.back()));
  windows_ = std::move(fewer);
  steps_a_window_ *= 2;
}

}  // namespace mebots::soc::observe
