// SPDX-License-Identifier: Apache-2.0
#include "solver/wiring.hpp"

#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace mebots::master {
namespace {

/// Maximum number of sweeps over a loop.
constexpr int kMostSweeps = 200;

/// True if two values differ by at most a few rounding errors.
bool is_close(double a, double b) {
  constexpr double kRoundings = 4 * std::numeric_limits<double>::epsilon();
  return a == b || std::abs(a - b) <= kRoundings * std::max(std::abs(a), std::abs(b));
}

}  // namespace

/// Determines the stages in which outputs are read and inputs are set.
class Wiring::Builder {
 public:
  Builder(Wiring& wiring, const std::vector<Wire>& wires) : wiring_(wiring) {
    for (const auto& wire : wires) {
      names_.emplace(wire.from, wire.from_name);
      names_.emplace(wire.to, wire.to_name);
      sources_[wire.to].push_back(&wire);
    }
    for (const auto& wire : wires) waits_for_.try_emplace(wire.from, waited_for(wire));
  }

  void run() {
    while (!waits_for_.empty()) {
      const auto outputs = ready_outputs();
      if (outputs.empty()) break;
      for (const auto& output : outputs) waits_for_.erase(output);
      wiring_.stages_.push_back(stage_of(outputs));
    }
    if (waits_for_.empty()) return;
    wiring_.loop_path_ = path();
    std::vector<MemberVariable> left;
    for (const auto& [output, inputs] : waits_for_) left.push_back(output);
    waits_for_.clear();
    wiring_.loop_ = stage_of(left);
  }

 private:
  /// Returns the connected inputs that must be set before the output of a wire is read.
  std::set<MemberVariable> waited_for(const Wire& wire) const {
    std::set<MemberVariable> inputs;
    if (wire.dependencies) {
      for (const auto reference : *wire.dependencies) {
        const MemberVariable input{wire.from.member, reference};
        if (sources_.contains(input)) inputs.insert(input);
      }
      return inputs;
    }
    for (const auto& [input, wires] : sources_) {
      if (input.member == wire.from.member) inputs.insert(input);
    }
    return inputs;
  }

  std::vector<MemberVariable> ready_outputs() const {
    std::vector<MemberVariable> outputs;
    for (const auto& [output, inputs] : waits_for_) {
      if (std::ranges::none_of(inputs, [&](const auto& input) { return sources_.contains(input); }))
        outputs.push_back(output);
    }
    return outputs;
  }

  /// Returns a stage that reads `outputs`, which must be in ascending order. After that, the stage sets the inputs for
  /// which no output is missing any more.
  Stage stage_of(const std::vector<MemberVariable>& outputs) {
    Stage stage;
    for (const auto& output : outputs) {
      places_[output] = wiring_.outputs_.size();
      add(stage.reads, output, wiring_.outputs_.size());
      wiring_.outputs_.push_back(0);
    }
    for (auto source = sources_.begin(); source != sources_.end();) {
      const auto& [input, wires] = *source;
      if (std::ranges::any_of(wires, [&](const Wire* wire) { return waits_for_.contains(wire->from); })) {
        ++source;
        continue;
      }
      add(stage.writes, input, wiring_.inputs_.size());
      wiring_.inputs_.push_back(0);
      auto& terms = wiring_.terms_.emplace_back();
      for (const auto* wire : wires) terms.push_back({places_.at(wire->from), wire->factor, wire->offset});
      source = sources_.erase(source);
    }
    return stage;
  }

  template <typename Call>
  static void add(std::vector<Call>& calls, const MemberVariable& variable, std::size_t place) {
    if (calls.empty() || calls.back().member != variable.member)
      calls.push_back({.member = variable.member, .first = place});
    calls.back().references.push_back(variable.reference);
  }

  /// Returns a loop among the outputs that no stage can read, such as "a.y -> b.u -> b.y -> a.u -> a.y". Searches
  /// backwards along the wires.
  std::string path() const {
    std::vector<MemberVariable> walk;
    auto output = waits_for_.begin()->first;
    while (std::ranges::find(walk, output) == walk.end()) {
      walk.push_back(output);
      const auto& inputs = waits_for_.at(output);
      const auto input = *std::ranges::find_if(inputs, [&](const auto& i) { return sources_.contains(i); });
      walk.push_back(input);
      const auto& wires = sources_.at(input);
      output = (*std::ranges::find_if(wires, [&](const Wire* w) { return waits_for_.contains(w->from); }))->from;
    }
    walk.push_back(output);
    const std::vector<MemberVariable> loop(std::ranges::find(walk, output), walk.end());
    std::vector<std::string> names;
    std::ranges::transform(loop.rbegin(), loop.rend(), std::back_inserter(names),
                           [&](const auto& variable) { return names_.at(variable); });
    return fmt::format("{}", fmt::join(names, " -> "));
  }

  Wiring& wiring_;
  std::map<MemberVariable, std::string> names_;
  std::map<MemberVariable, std::vector<const Wire*>> sources_;    // wires to inputs that are in no stage yet
  std::map<MemberVariable, std::set<MemberVariable>> waits_for_;  // indexed by outputs that are in no stage yet
  std::map<MemberVariable, std::size_t> places_;                  // indices of outputs in stages
};

Wiring::Wiring(std::vector<ContinuousInstance*> members, const std::vector<Wire>& wires)
    : members_(std::move(members)) {
  Builder(*this, wires).run();
}

Evaluation Wiring::evaluate() {
  for (const auto& stage : stages_) {
    if (read(stage) != Evaluation::ok) return Evaluation::recoverable;
    collect(stage);
    if (write(stage) != Evaluation::ok) return Evaluation::recoverable;
  }
  return has_loop() ? settle_loop() : Evaluation::ok;
}

Evaluation Wiring::read(const Stage& stage) {
  for (const auto& call : stage.reads) {
    const auto values = std::span(outputs_).subspan(call.first, call.references.size());
    if (members_[call.member]->get_outputs(call.references, values) != Evaluation::ok) return Evaluation::recoverable;
  }
  return Evaluation::ok;
}

/// Computes the inputs that `stage` sets. An input is the sum of factor * output + offset over all wires that end at
/// it.
void Wiring::collect(const Stage& stage) {
  for (const auto& call : stage.writes) {
    for (auto input = call.first; input < call.first + call.references.size(); ++input) {
      double value = 0;
      for (const auto& term : terms_[input]) {
        const double part = term.factor == 1 && term.offset == 0 ? outputs_[term.output]
                                                                 : term.factor * outputs_[term.output] + term.offset;
        value = &term == terms_[input].data() ? part : value + part;
      }
      inputs_[input] = value;
    }
  }
}

Evaluation Wiring::write(const Stage& stage) {
  for (const auto& call : stage.writes) {
    const auto values = std::span(inputs_).subspan(call.first, call.references.size());
    if (members_[call.member]->set_inputs(call.references, values) != Evaluation::ok) return Evaluation::recoverable;
  }
  return Evaluation::ok;
}

Evaluation Wiring::settle_loop() {
  if (!loop_start_.empty()) {
    const auto first = loop_.writes.front().first;
    std::ranges::copy(std::span(loop_start_).subspan(first), inputs_.begin() + static_cast<std::ptrdiff_t>(first));
    if (write(loop_) != Evaluation::ok) return Evaluation::recoverable;
  }
  std::vector<double> before;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    if (read(loop_) != Evaluation::ok) return Evaluation::recoverable;
    before = inputs_;
    collect(loop_);
    if (write(loop_) != Evaluation::ok) return Evaluation::recoverable;
    if (sweep > 0 && std::ranges::equal(before, inputs_, is_close)) return Evaluation::ok;
  }
  throw Error(
      ErrorCode::algebraic_loop,
      fmt::format("an algebraic loop does not converge within {} sweeps: {}. Cut the loop, for example by an FMU "
                  "with a state",
                  kMostSweeps, loop_path_));
}

void Wiring::propagate(std::size_t member, std::size_t state, std::span<const std::size_t> first_states,
                       std::span<double> derivatives) {
  MEBOTS_ASSERT(!has_loop() && first_states.size() == members_.size());
  std::vector<Change> changes(members_.size());
  changes[member] = {{members_[member]->state_references()[state]}, {1.0}};
  std::vector<double> output_changes(outputs_.size(), 0.0);
  for (const auto& stage : stages_) {
    for (const auto& call : stage.reads) {
      const auto& change = changes[call.member];
      if (change.knowns.empty()) continue;
      members_[call.member]->directional_derivatives(
          call.references, change.knowns, change.seed,
          std::span(output_changes).subspan(call.first, call.references.size()));
    }
    change_inputs(stage, output_changes, changes);
  }
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const auto unknowns = members_[m]->derivative_references();
    if (changes[m].knowns.empty() || unknowns.empty()) continue;
    members_[m]->directional_derivatives(unknowns, changes[m].knowns, changes[m].seed,
                                         derivatives.subspan(first_states[m], unknowns.size()));
  }
}

void Wiring::change_inputs(const Stage& stage, std::span<const double> output_changes,
                           std::vector<Change>& changes) const {
  for (const auto& call : stage.writes) {
    for (std::size_t i = 0; i < call.references.size(); ++i) {
      double change = 0;
      for (const auto& term : terms_[call.first + i]) change += term.factor * output_changes[term.output];
      if (change == 0) continue;
      changes[call.member].knowns.push_back(call.references[i]);
      changes[call.member].seed.push_back(change);
    }
  }
}

}  // namespace mebots::master
