// SPDX-License-Identifier: Apache-2.0
#include "soc/decisions.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::soc {

void Decisions::picture_stored(const PictureTimes& times, const CoreWork& work) {
  // The times are checked, because a device from any library may have reported them.
  if (times.asked > times.exposed || times.exposed > times.read_out || times.read_out > times.stored) {
    throw Error(fmt::format(
        "picture_stored(): a device of the board says that its picture was requested at {} ps, exposed from "
        "{} ps, read out from {} ps and stored at {} ps; these times must not decrease",
        times.asked, times.exposed, times.read_out, times.stored));
  }
  if (sender_.empty()) return;
  if (picture_) {
    next_ = times;
    return;
  }
  picture_ = times;
  begun_ = times.stored;
  before_ = work;
}

void Decisions::sent(std::string_view sender, Picoseconds now, const CoreWork& work) {
  if (sender_.empty() || sender != sender_ || !picture_) return;
  published(now);  // replaces set-points that were sent earlier in the same step
  Decision decision;
  decision.part(DecisionPart::request) = picture_->exposed - picture_->asked;
  decision.part(DecisionPart::exposure) = picture_->read_out - picture_->exposed;
  decision.part(DecisionPart::read_out) = picture_->stored - picture_->read_out;
  // The fabric controller sends the set-points. Its time may be up to one instruction later than the time of a device
  // or of the cluster.
  const auto span = std::max<Picoseconds>(now - begun_, 0);
  const auto inference = std::clamp<Picoseconds>(work.cluster - before_.cluster, 0, span);
  const auto deciding = std::clamp<Picoseconds>(work.controller - before_.controller, 0, span - inference);
  decision.part(DecisionPart::inference) = inference;
  decision.part(DecisionPart::deciding) = deciding;
  decision.part(DecisionPart::wait) = now - picture_->stored - inference - deciding;
  decision.awake[0] = work.controller_awake - before_.controller_awake;
  for (std::size_t core = 0; core < kMostClusterCores && work.cluster_hz != 0; ++core) {
    const auto cycles = static_cast<double>(work.core_cycles[core] - before_.core_cycles[core]);
    decision.awake[1 + core] = std::llround(cycles / work.cluster_hz * kPsPerS);
  }
  ended_ = decision;
  requested_ = picture_->asked;
  sent_at_ = now;
  picture_ = next_;
  next_.reset();
  begun_ = now;
  before_ = work;
}

void Decisions::published(Picoseconds now) {
  if (!ended_) return;
  ended_->part(DecisionPart::sending) = now - sent_at_;
  ended_->latency = now - requested_;
  last_ = *ended_;
  ended_.reset();
  ++count_;
  for (std::size_t i = 0; i < kDecisionParts; ++i) sum_.parts[i] += last_.parts[i];
  for (std::size_t i = 0; i < kMostHarts; ++i) sum_.awake[i] += last_.awake[i];
  sum_.latency += last_.latency;
  longest_ = std::max(longest_, last_.latency);
}

void Decisions::visit(state::Visitor& v) {
  v("picture", picture_);
  v("next", next_);
  v("begun", begun_);
  v("before", before_);
  v("ended", ended_);
  v("asked", requested_);
  v("sent_at", sent_at_);
  v("count", count_);
  v("last", last_);
  v("sum", sum_);
  v("longest", longest_);
}

}  // namespace mebots::soc
