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

/// Parts of the time from the request for a picture to published set-points, in the order of the FMU's outputs.
/// docs/concepts/latency.md defines them.
enum class DecisionPart : std::uint8_t { request, exposure, read_out, wait, inference, deciding, sending };
inline constexpr std::size_t kDecisionParts = 7;

/// Times and cycles for which the cores have worked since reset.
struct CoreWork {
  Picoseconds cluster = 0;  // time in which a cluster core was awake, or in which all cluster cores waited for the DMA
  Picoseconds controller = 0;  // time in which the fabric controller was awake and the cluster did nothing
  Picoseconds controller_awake = 0;
  std::array<std::uint64_t, kMostClusterCores> core_cycles{};  // cycles in which each cluster core was awake
  std::uint32_t cluster_hz = 0;

  void visit(state::Visitor& v) {
    v("cluster", cluster);
    v("controller", controller);
    v("controller_awake", controller_awake);
    v("core_cycles", core_cycles);
    v("cluster_hz", cluster_hz);
  }
};

/// Times of one decision, or their sums over several decisions.
struct Decision {
  std::array<Picoseconds, kDecisionParts> parts{};
  Picoseconds latency = 0;  // time from the request to the end, measured separately from the parts
  std::array<Picoseconds, kMostHarts>
      awake{};  // awake time of each hart since the picture could be used, indexed by hart number

  Picoseconds& part(DecisionPart which) { return parts[static_cast<std::size_t>(which)]; }
  void visit(state::Visitor& v) {
    v("parts", parts);
    v("latency", latency);
    v("awake", awake);
  }
};

/// Measures decisions. A decision lasts from a picture to the set-points that the program computes from it.
///
///   picture_stored()   a picture is in memory. If no decision is in progress, one about this picture begins. Otherwise
///                      the picture waits, and replaces the picture that was waiting, if any. Throws Error if times are
///                      not in order.
///   sent()             the board's sender has sent set-points: the decision about the picture ends. The next decision
///                      is about the waiting picture. Has no effect without a picture.
///   published()        the sent values are visible outside: the end of the FMU's step.
class Decisions {
 public:
  /// `sender` is the name of the device that sends set-points. If it is empty, there are no decisions.
  explicit Decisions(std::string sender) : sender_(std::move(sender)) {}

  void picture_stored(const PictureTimes& times, const CoreWork& work);
  void sent(std::string_view sender, Picoseconds now, const CoreWork& work);
  void published(Picoseconds now);

  std::uint64_t count() const { return count_; }
  const Decision& last() const { return last_; }
  const Decision& sum() const { return sum_; }
  Picoseconds longest() const { return longest_; }

  void visit(state::Visitor& v);

 private:
  std::string sender_;
  std::optional<PictureTimes> picture_;  // picture of the decision that is in progress
  std::optional<PictureTimes> next_;
  Picoseconds begun_ = 0;          // time at which the decision in progress could begin
  CoreWork before_;                // work of the cores up to `begun_`
  std::optional<Decision> ended_;  // decision whose set-points were sent, but not published yet
  Picoseconds requested_ = 0;      // time at which the picture of `ended_` was requested
  Picoseconds sent_at_ = 0;
  std::uint64_t count_ = 0;
  Decision last_;
  Decision sum_;
  Picoseconds longest_ = 0;
};

}  // namespace mebots::soc
