// SPDX-License-Identifier: Apache-2.0
#include "host_interfaces.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace mebots::master::isolation {
namespace {

void put_update(SharedWriter& answers, const DiscreteUpdate& update) {
  answers.put(Answer::done);
  answers.put(update.needs_another);
  answers.put(update.terminate);
  answers.put_optional(update.next_event_s);
}

void put_evaluation(SharedWriter& answers, Evaluation evaluation) {
  answers.put(Answer::done);
  answers.put(evaluation != Evaluation::ok);
}

/// Writes an answer with the numbers of `evaluate`. The numbers are invalid if the FMU discards the evaluation.
template <typename Evaluate>
void put_values(SharedWriter& answers, std::size_t count, Evaluate evaluate) {
  std::vector<double> values(count);
  const Evaluation evaluation = evaluate(std::span<double>(values));
  put_evaluation(answers, evaluation);
  answers.put(std::span<const double>(values));
}

}  // namespace

bool dispatch(ContinuousInstance& instance, Call call, SharedReader& commands, SharedWriter& answers) {
  switch (call) {
    case Call::set_time:
      instance.set_time(commands.get<double>());
      break;
    case Call::get_states:
      put_values(answers, instance.state_count(), [&](auto values) {
        instance.get_states(values);
        return Evaluation::ok;
      });
      return true;
    case Call::set_states:
      put_evaluation(answers, instance.set_states(commands.get_vector<double>()));
      return true;
    case Call::get_derivatives:
      put_values(answers, instance.state_count(), [&](auto values) { return instance.get_derivatives(values); });
      return true;
    case Call::get_indicators:
      put_values(answers, instance.indicator_count(), [&](auto values) { return instance.get_indicators(values); });
      return true;
    case Call::get_nominals:
      put_values(answers, instance.state_count(), [&](auto values) {
        instance.get_nominals(values);
        return Evaluation::ok;
      });
      return true;
    case Call::get_outputs: {
      const auto references = commands.get_vector<ValueReference>();
      put_values(answers, references.size(), [&](auto values) { return instance.get_outputs(references, values); });
      return true;
    }
    case Call::set_inputs: {
      const auto references = commands.get_vector<ValueReference>();
      put_evaluation(answers, instance.set_inputs(references, commands.get_vector<double>()));
      return true;
    }
    case Call::enter_event_mode:
      instance.enter_event_mode();
      break;
    case Call::update_discrete_states:
      put_update(answers, instance.update_discrete_states());
      return true;
    case Call::enter_continuous_time_mode:
      instance.enter_continuous_time_mode();
      break;
    case Call::completed_step: {
      const auto step = instance.completed_step();
      answers.put(Answer::done);
      answers.put(step.enter_event_mode);
      answers.put(step.terminate);
      return true;
    }
    case Call::directional_derivatives: {
      const auto unknowns = commands.get_vector<ValueReference>();
      const auto knowns = commands.get_vector<ValueReference>();
      const auto seed = commands.get_vector<double>();
      put_values(answers, unknowns.size(), [&](auto change) {
        instance.directional_derivatives(unknowns, knowns, seed, change);
        return Evaluation::ok;
      });
      return true;
    }
    default:
      return false;
  }
  answers.put(Answer::done);
  return true;
}

bool dispatch(EventInstance& instance, Call call, SharedReader& commands, SharedWriter& answers) {
  switch (call) {
    case Call::step_until: {
      const auto start_s = commands.get<double>();
      const auto end = instance.step_until(start_s, commands.get<double>());
      answers.put(Answer::done);
      answers.put(end.has_value());
      answers.put(end && end->event);
      answers.put(end && end->terminate);
      answers.put(end ? end->time_s : 0);
      return true;
    }
    case Call::enter_event_mode:
      instance.enter_event_mode();
      break;
    case Call::enter_step_mode:
      instance.enter_step_mode();
      break;
    case Call::update_discrete_states:
      put_update(answers, instance.update_discrete_states());
      return true;
    default:
      return false;
  }
  answers.put(Answer::done);
  return true;
}

bool dispatch(ClockInstance& instance, Call call, SharedReader& commands, SharedWriter& answers) {
  switch (call) {
    case Call::ticks: {
      const bool ticks = instance.ticks(commands.get<ValueReference>());
      answers.put(Answer::done);
      answers.put(ticks);
      return true;
    }
    case Call::tick:
      instance.tick(commands.get<ValueReference>());
      break;
    case Call::new_interval: {
      const auto interval_s = instance.new_interval(commands.get<ValueReference>());
      answers.put(Answer::done);
      answers.put_optional(interval_s);
      return true;
    }
    case Call::shift: {
      const auto shift_s = instance.shift(commands.get<ValueReference>());
      answers.put(Answer::done);
      answers.put(shift_s);
      return true;
    }
    default:
      return false;
  }
  answers.put(Answer::done);
  return true;
}

}  // namespace mebots::master::isolation
