// SPDX-License-Identifier: Apache-2.0
#include "observe/profile_windows.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

namespace mebots::soc::observe {
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
  if (window.from == window.to && !windows_.empty()) {  // what the end settles is the last window's
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
