// SPDX-License-Identifier: Apache-2.0
#include "run/draws.hpp"

#include "base/sha256.hpp"
#include "base/signal_guard.hpp"
#include "base/time.hpp"
#include "io/config/load_system.hpp"
#include "resolve/resolve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace mebots::master {
namespace {

using Json = nlohmann::ordered_json;
using modeldesc::Causality;

constexpr std::string_view kPrefix = "calibration.";

/// Widens each interval in `intervals` to include the number with the same label in `values`. Integers and texts have
/// no interval.
void widen(Json& intervals, const Json& values) {
  for (const auto& [label, value] : values.items()) {
    if (value.is_object()) {
      widen(intervals[label], value);
    } else if (value.is_number_float()) {
      const auto number = value.get<double>();
      auto& interval = intervals[label];
      if (interval.is_null()) interval = {number, number};
      interval = {std::min(interval[0].get<double>(), number), std::max(interval[1].get<double>(), number)};
    }
  }
  if (intervals.is_null()) intervals = Json::object();
}

void remove_empty(Json& intervals) {
  for (auto it = intervals.begin(); it != intervals.end();) {
    if (it->is_object()) remove_empty(*it);
    it = it->empty() ? intervals.erase(it) : std::next(it);
  }
}

}  // namespace

double unit_draw(std::int64_t seed, std::string_view name, std::int64_t index) {
  auto text = std::to_string(seed);
  text.push_back('\0');
  text += name;
  text.push_back('\0');
  text += std::to_string(index);
  const auto digits = sha256(text).substr(0, 16);
  std::uint64_t bits = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), bits, 16);
  return static_cast<double>(bits >> 11U) * 0x1p-53 + 0x1p-54;
}

std::vector<std::string> calibration_parameters(const ResolvedSystem& system) {
  std::vector<std::string> names;
  for (const auto& instance : system.instances) {
    for (const auto& variable : instance.model->variables) {
      const bool is_set = std::ranges::any_of(
          instance.starts, [&](const StartValue& start) { return start.variable->name == variable.name; });
      if (variable.causality == Causality::parameter && variable.name.starts_with(kPrefix) && !is_set)
        names.push_back(instance.description->name + "." + variable.name);
    }
  }
  return names;
}

std::vector<std::string> calibration_parameters(const std::filesystem::path& config) {
  const auto system = read_config(config);
  FmuLibrary library;
  return calibration_parameters(resolve(system, library));
}

DrawnFlights::DrawnFlights(Run& run) : run_(&run), parameters_(calibration_parameters(run.resolved())) {
  if (!parameters_.empty()) return;
  throw InputError(ErrorCode::unknown_name,
                   "uncertainty: no FMU of this system has a parameter calibration.* that can be drawn");
}

bool DrawnFlights::fly(const Progress& progress) {
  for (int flight = 1; flight <= kFlights; ++flight) {
    progress(flight);
    fly_one(flight);
    if (interrupted_ || run_->interrupt_flag()) return false;
  }
  return true;
}

void DrawnFlights::fly_one(int flight) {
  auto options = run_->options();
  options.out.clear();
  options.in_memory = false;
  options.statistics = false;
  options.checkpoint_every_s.reset();
  for (const auto& name : parameters_)
    options.settings.push_back({name, 2 * unit_draw(kSeed, name, flight - 1) - 1, "uncertainty"});
  try {
    Run run(run_->system().file, options, run_->library());
    run.free_at_end();
    run.listen([this](const Message& message) {
      if (message.severity == Severity::warning && message.text.starts_with(kPrefix))
        without_effect_.insert(fmt::format("{}: {}", message.instance, message.text));
    });
    const SignalGuard guard(run.interrupt_flag());
    run.run();
    interrupted_ = run.report().end_reason == EndReason::interrupted;
    ++outcomes_[run.outcome()];
    Json values = run.values().values();
    values["simulated_time"] = to_seconds(run.report().simulated_ns);
    summaries_.push_back(std::move(values));
  } catch (const InputError&) {
    throw;
  } catch (const Error&) {
    ++outcomes_["failed"];
  }
}

Json DrawnFlights::json() const {
  Json intervals;
  for (const auto& summary : summaries_) widen(intervals, summary);
  remove_empty(intervals);
  Json found = {{"kind", "calibration"},     {"flights", kFlights},   {"level", kLevel},       {"seed", kSeed},
                {"parameters", parameters_}, {"outcomes", outcomes_}, {"intervals", intervals}};
  if (!without_effect_.empty()) found["without_effect"] = without_effect_;
  return found;
}

bool wants_draws(const Run& run) {
  if (run.report().end_reason == EndReason::interrupted) return false;
  return run.options().draws_calibration.value_or(run.system().draws_calibration);
}

void add_draws(Run& run) {
  if (!wants_draws(run)) return;
  const auto skip = [&run](std::string_view reason) {
    run.report_uncertainty({{"kind", "calibration"}, {"skipped", reason}});
  };
  if (!run.report().writes.empty()) return skip("a program wrote variables during the run, which the draws would lack");
  if (run.began_later()) return skip("the run started from a saved state, where no draw can start");
  DrawnFlights draws(run);
  if (!draws.fly([](int) {})) return skip("interrupted");
  run.report_uncertainty(draws.json());
}

}  // namespace mebots::master
