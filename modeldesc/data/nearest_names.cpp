// SPDX-License-Identifier: Apache-2.0
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace mebots {
namespace {

constexpr std::size_t kOffered = 3;
constexpr std::size_t kListed = 12;

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Returns edit_distance() if it is at most `most`, otherwise any number above `most`. Returns as soon as the distance
/// is known to exceed `most`, so a file with many wrong names is rejected quickly.
std::size_t bounded_distance(std::string_view a, std::string_view b, std::size_t most) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > most) return most + 1;
  std::vector<std::size_t> rows(3 * (b.size() + 1));
  auto* before_last = rows.data();
  auto* last = before_last + b.size() + 1;
  auto* row = last + b.size() + 1;
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  std::size_t nearest_of_last = 0;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before_last, last);
    std::swap(last, row);
    row[0] = i;
    auto nearest = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
      nearest = std::min(nearest, row[j]);
    }
    // Each row of the table of distances depends only on the two rows before it. Therefore no value in a later row is
    // below the minimum of these two rows.
    if (std::min(nearest, nearest_of_last) > most) return most + 1;
    nearest_of_last = nearest;
  }
  return row[b.size()];
}

std::string in_quotes(std::string_view name) {
  return fmt::format("'{}'", name);
}

std::string one_of(const std::vector<std::string>& names) {
  std::string text = in_quotes(names.front());
  for (std::size_t i = 1; i < names.size(); ++i) text += (i + 1 == names.size() ? " or " : ", ") + in_quotes(names[i]);
  return text;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  return bounded_distance(a, b, std::max(a.size(), b.size()));
}

std::string suggest(std::string_view wrong, std::span<const std::string> known) {
  if (known.empty()) return "There are none.";
  struct Candidate {
    std::size_t distance;
    const std::string* name;
  };
  std::vector<Candidate> candidates;
  for (const auto& name : known) {
    // If one name contains the other, they count as similar, even if their lengths differ much.
    const bool contained = wrong.size() >= 3 && name.size() >= 3 &&
                           (name.find(wrong) != std::string::npos || wrong.find(name) != std::string_view::npos);
    const auto most = contained ? 1 : std::max<std::size_t>(1, std::max(wrong.size(), name.size()) / 3);
    const auto distance = bounded_distance(wrong, name, most);
    if (contained || distance <= most) candidates.push_back({distance, &name});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  if (!candidates.empty()) {
    std::vector<std::string> nearest;
    for (const auto& candidate : candidates) {
      if (nearest.size() == kOffered) break;
      nearest.push_back(*candidate.name);
    }
    return fmt::format("Did you mean {}?", one_of(nearest));
  }
  std::vector<std::string> listed;
  for (const auto& name : known) {
    if (listed.size() == kListed) break;
    listed.push_back(in_quotes(name));
  }
  const auto more = known.size() - listed.size();
  return fmt::format("Known are {}{}.", fmt::join(listed, ", "), more == 0 ? "" : fmt::format(" and {} more", more));
}

}  // namespace mebots
