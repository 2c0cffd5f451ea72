// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"
#include "mebots/soc/device_kind.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::soc {

/// What the time from a request for a picture to set-points that everybody sees consists of, in the order of the FMU's
/// outputs. Definitions for users: docs/concepts/latency.md.
enum class DecisionPart : std::uint8_t { request, exposure, read_out, wait, inference, deciding, sending };
inline constexpr std::size_t kDecisionParts = 7;

/// What the cores have done from reset up to some time.
struct CoreWork {
  Picoseconds cluster = 0;     // while a core of the cluster was awake, or all waited for the cluster's DMA
  Picoseconds controller = 0;  // while the fabric controller was awake and the cluster did nothing
  Picoseconds controller_awake = 0;
  std::array<std::uint64_t, kMostClusterCores> core_cycles{};  // in which each core of the cluster was awake
  std::uint32_t cluster_hz = 0;

  void visit(state::Visitor& v) {
    v("cluster", cluster);
    v("controller", controller);
    v("controller_awake", controller_awake);
    v("core_cycles", core_cycles);
    v("cluster_hz", cluster_hz);
  }
};

/// The times of one decision, or sums over several.
struct Decision {
  std::array<Picoseconds, kDecisionParts> parts{};
  Picoseconds latency = 0;                      // from the request to the end; taken by itself, not as a sum
  std::array<Picoseconds, kMostHarts> awake{};  // each hart by its number, from when the picture could be looked at

  Picoseconds& part(DecisionPart which) { return parts[static_cast<std::size_t>(which)]; }
  void visit(state::Visitor& v) {
    v("parts", parts);
    v("latency", latency);
    v("awake", awake);
  }
};

/// How long the program takes from a picture to the set-points that rest on it.
///
///   picture_stored()   a picture is in memory. If nothing is being decided it is the one that is decided about; else
///                      it waits, in place of one that waited before. Throws Error for times out of their order.
///   sent()             the board's sender has sent: ends the decision about the picture. The one that waits is next.
///                      Without a picture this is not a decision.
///   published()        the world outside sees what was sent: the end of the FMU's step.
class Decisions {
 public:
  /// `sender`: the board's word for what sends set-points; empty = nothing does, and there are no decisions.
  explicit Decisions(std::string sender) : sender_(std::move(sender)) {}

  void picture_stored(const PictureTimes& times, const CoreWork& work);
  void sent(std::string_view sender, Picoseconds now, const CoreWork& work);
  void published(Picoseconds now);

  std::uint64_t count() const { return count_; }
  const Decision& last() const { return last_; }
  /// Over all decisions.
  const Decision& sum() const { return sum_; }
  Picoseconds longest() const { return longest_; }

  void visit(state::Visitor& v);

 private:
  std::string sender_;
  std::optional<PictureTimes> picture_;  // that is being decided about
  std::optional<PictureTimes> next_;
  Picoseconds begun_ = 0;          // when it could be
  CoreWork before_;                // up to then
  std::optional<Decision> ended_;  // sent, not yet published
  Picoseconds requested_ = 0;      // of it
  Picoseconds sent_at_ = 0;
  std::uint64_t count_ = 0;
  Decision last_;
  Decision sum_;
  Picoseconds longest_ = 0;
};

}  // namespace mebots::soc
