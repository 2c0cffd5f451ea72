// SPDX-License-Identifier: Apache-2.0
#include "slave/continuous/continuous_slave.hpp"

#include "mebots/state/save.hpp"
#include "slave/continuous/continuous_group.hpp"
#include "slave/extrapolation.hpp"
#include "slave/member_state.hpp"

#include <algorithm>
#include <utility>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Variability;

}  // namespace

void ContinuousSlave::Course::visit(state::Visitor& v) {
  v("reference", reference);
  v("value", value);
  v("derivatives", derivatives);
}

ContinuousSlave::ContinuousSlave(std::unique_ptr<Slave> inner, ContinuousInstance& instance,
                                 std::shared_ptr<ContinuousGroup> group)
    : ForwardingSlave(std::move(inner)), instance_(&instance), group_(std::move(group)), member_(group_->add(*this)) {
  for (const auto& variable : description().variables) {
    const bool is_continuous = variable.causality == Causality::input && kind_of(variable.type) == ValueKind::real &&
                               variable.variability == Variability::continuous;
    if (is_continuous) continuous_inputs_.insert(variable.value_reference);
    if (is_clocked(variable)) clocked_.insert(variable.value_reference);
  }
}

void ContinuousSlave::setup_experiment(const Experiment& experiment) {
  inner().setup_experiment(experiment);
  group_->setup_experiment(experiment);
}

void ContinuousSlave::exit_initialization() {
  group_->start_clocks(member_);
  inner().exit_initialization();
  group_->exit_initialization();
}

StepResult ContinuousSlave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  return group_->step(start_ns, duration_ns);
}

void ContinuousSlave::drop_course(ValueReference reference) {
  std::erase_if(courses_, [&](const Course& course) { return course.reference == reference; });
}

void ContinuousSlave::set_reals(std::span<const ValueReference> references, std::span<const double> values) {
  std::vector<ValueReference> changed;
  std::vector<double> changed_values;
  bool continuous = false;
  bool discrete = false;
  for (std::size_t i = 0; i < references.size(); ++i) {
    const bool had_course = std::ranges::find(courses_, references[i], &Course::reference) != courses_.end();
    if (had_course) drop_course(references[i]);
    if (!reals_.update(references[i], values[i]) && !had_course) continue;
    changed.push_back(references[i]);
    changed_values.push_back(values[i]);
    if (clocked_.contains(references[i])) continue;
    (continuous_inputs_.contains(references[i]) ? continuous : discrete) = true;
  }
  if (changed.empty()) return;
  if (group_->is_integrating()) {
    if (discrete) group_->enter_event_mode();
    if (continuous) group_->input_changed();
  }
  inner().set_reals(changed, changed_values);
}

template <typename T>
void ContinuousSlave::set_discrete(KnownValues<T>& known, std::span<const ValueReference> references,
                                   std::span<const T> values,
                                   void (Slave::*set)(std::span<const ValueReference>, std::span<const T>)) {
  std::vector<ValueReference> changed;
  std::vector<T> changed_values;
  bool is_event = false;
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (!known.update(references[i], values[i])) continue;
    changed.push_back(references[i]);
    changed_values.push_back(values[i]);
    is_event |= !clocked_.contains(references[i]);
  }
  if (changed.empty()) return;
  if (is_event && group_->is_integrating()) group_->enter_event_mode();
  (inner().*set)(changed, changed_values);
}

void ContinuousSlave::set_integers(std::span<const ValueReference> references, std::span<const WholeNumber> values) {
  set_discrete(integers_, references, values, &Slave::set_integers);
}

void ContinuousSlave::set_booleans(std::span<const ValueReference> references, std::span<const WholeNumber> values) {
  set_discrete(booleans_, references, values, &Slave::set_booleans);
}

void ContinuousSlave::set_strings(std::span<const ValueReference> references, std::span<const std::string> values) {
  set_discrete(strings_, references, values, &Slave::set_strings);
}

void ContinuousSlave::set_binaries(std::span<const ValueReference> references, std::span<const std::string> values) {
  set_discrete(strings_, references, values, &Slave::set_binaries);
}

void ContinuousSlave::set_input_derivatives(std::span<const ValueReference> references,
                                            std::span<const std::int32_t> orders, std::span<const double> values) {
  // The derivatives of an input are adjacent in `references`. Their orders start at 1.
  for (std::size_t i = 0; i < references.size();) {
    Course course;
    course.reference = references[i];
    const auto* const value = reals_.find(references[i]);
    if (value != nullptr) course.value = *value;
    bool any = false;
    for (; i < references.size() && references[i] == course.reference; ++i) {
      course.derivatives.resize(static_cast<std::size_t>(orders[i]));
      course.derivatives.back() = values[i];
      any |= values[i] != 0;
    }
    if (!any || value == nullptr || !continuous_inputs_.contains(course.reference)) continue;
    drop_course(course.reference);
    courses_.push_back(std::move(course));
    group_->input_changed();
  }
}

Evaluation ContinuousSlave::set_courses(double since_s) {
  std::vector<ValueReference> references;
  std::vector<double> values;
  for (const auto& course : courses_) {
    references.push_back(course.reference);
    values.push_back(extrapolated(course.value, course.derivatives, since_s));
  }
  return instance_->set_inputs(references, values);
}

bool ContinuousSlave::set_in_event(ValueKind kind, ValueReference reference, const LinkValue& value) {
  const bool changes = std::visit(
      [&]<typename T>(const T& known) {
        if constexpr (std::is_same_v<T, double>) return reals_.update(reference, known);
        if constexpr (std::is_same_v<T, std::string>) return strings_.update(reference, known);
        if constexpr (std::is_same_v<T, WholeNumber>)
          return (kind == ValueKind::boolean ? booleans_ : integers_).update(reference, known);
      },
      value);
  if (changes) set_value(inner(), kind, reference, value);
  return changes;
}

void ContinuousSlave::visit(state::Visitor& v) {
  v("reals", reals_);
  v("integers", integers_);
  v("booleans", booleans_);
  v("strings", strings_);
  v("courses", courses_);
}

std::unique_ptr<SlaveState> ContinuousSlave::save_state() {
  auto state = std::make_unique<MemberState>();
  state->inner = inner().save_state();
  state->own = state::save(*this);
  if (member_ == 0) state->group = group_->save();
  return state;
}

void ContinuousSlave::restore_state(const SlaveState& state) {
  const auto& saved = static_cast<const MemberState&>(state);
  inner().restore_state(*saved.inner);
  state::restore(*this, saved.own);
  if (member_ == 0) group_->restore(saved.group);
}

std::vector<std::byte> ContinuousSlave::serialize(const SlaveState& state) {
  return serialize_member(inner(), static_cast<const MemberState&>(state));
}

std::unique_ptr<SlaveState> ContinuousSlave::deserialize(std::span<const std::byte> bytes) {
  return deserialize_member(inner(), bytes);
}

}  // namespace mebots::master
