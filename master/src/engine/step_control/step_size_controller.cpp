// SPDX-License-Identifier: Apache-2.0
#include "engine/step_control/step_size_controller.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <cmath>

namespace mebots::master {
namespace {

/// Errors are limited to this range. The factor of the step length reaches its own limits at less extreme errors.
/// Without the upper limit, two infinite errors in a row would yield 0 * infinity.
constexpr double kSmallestError = 1e-12;
constexpr double kLargestError = 1e12;
constexpr double kOrderOfGains = 2;

/// Clamps the error to the range from kSmallestError to kLargestError. NaN becomes kLargestError.
double bounded(double error) {
  return error < kLargestError ? std::max(error, kSmallestError) : kLargestError;
}

}  // namespace

StepSizeController::StepSizeController(const StepControlDescription& description)
    : description_(&description), wanted_(static_cast<double>(description.initial_steps)) {}

std::int64_t StepSizeController::next(std::int64_t limit) const {
  MEBOTS_ASSERT(limit > 0);
  const auto wanted = static_cast<std::int64_t>(wanted_);
  if (wanted >= limit) return limit;
  return wanted > limit / 2 ? limit - limit / 2 : wanted;
}

void StepSizeController::accept(const Step& step) {
  const auto& limits = *description_;
  const double error = std::pow(bounded(step.error), kOrderOfGains / step.order);
  const double exact = limits.safety * std::pow(error, -limits.integral_gain - limits.proportional_gain) *
                       std::pow(error_before_, limits.proportional_gain);
  const double factor = std::clamp(exact, limits.min_factor, step.was_repeated ? 1 : limits.max_factor);
  error_before_ = error;
  const bool was_cut = !step.was_repeated && step.length < static_cast<std::int64_t>(wanted_);
  const double taken = was_cut || step.was_repeated ? static_cast<double>(step.length) : wanted_;
  // If a forced point shortened the last step and its error was small, does not reduce the wanted length.
  const double least = was_cut && step.error <= 1 ? wanted_ : 0;
  wanted_ = std::clamp(std::max(taken * factor, least), static_cast<double>(limits.min_steps),
                       static_cast<double>(limits.max_steps));
}

void StepSizeController::restart() {
  wanted_ = static_cast<double>(description_->initial_steps);
  error_before_ = 1;
}

void StepSizeController::visit(state::Visitor& v) {
  v("wanted", wanted_);
  v("error_before", error_before_);
}

}  // namespace mebots::master
