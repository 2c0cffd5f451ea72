// SPDX-License-Identifier: Apache-2.0
// The public C++ interface of a Run.
#include "mebots/mission.hpp"

#include "base/signal_guard.hpp"
#include "base/time.hpp"
#include "mebots/hexadecimal.hpp"
#include "mebots/nearest_names.hpp"
#include "mebots/version.hpp"
#include "message/message_text.hpp"
#include "run/draws.hpp"
#include "run/run.hpp"
#include "slave/discrete_link.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <list>
#include <span>

namespace mebots {
namespace {

using namespace master;
using modeldesc::Type;

class PointListener final : public Observer {
 public:
  PointListener(Run& run, std::function<void(double)> listener) : run_(&run), listener_(std::move(listener)) {}

  std::optional<std::string> reached(const Point& point) override {
    run_->at_point([&] { listener_(run_->system().grid().time_s(point.time_ns)); });
    return std::nullopt;
  }

 private:
  Run* run_;
  std::function<void(double)> listener_;
};

}  // namespace

class Mission::Impl {
 public:
  explicit Impl(std::unique_ptr<Run> opened) : run(std::move(opened)) {}
  Impl(const std::filesystem::path& system, const RunOptions& requested)
      : config(std::filesystem::absolute(system)),
        options(with_absolute_paths(requested)),
        run(std::make_unique<Run>(system, requested)) {}

  ResolvedVariable find(std::string_view variable) {
    if (!run->busy()) run->start();
    return find_variable(*run, variable);
  }

  LinkValue read(std::size_t instance, const modeldesc::Variable& variable, const char* what) const {
    LinkValue value;
    run->call(instance, what,
              [&](Slave& slave) { value = get_value(slave, kind_of(variable.type), variable.value_reference); });
    return value;
  }

  std::filesystem::path config;  // empty for a resumed run
  RunOptions options;
  std::list<PointListener> listeners;  // declared before the run, which stores their addresses
  std::unique_ptr<Run> run;
};

Mission::Mission(const std::filesystem::path& config, const RunOptions& options)
    : Mission(std::make_unique<Impl>(config, options)) {}
Mission::Mission(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Mission::~Mission() = default;
Mission::Mission(Mission&& other) noexcept = default;
Mission& Mission::operator=(Mission&& other) noexcept = default;

Mission Mission::resume(const std::filesystem::path& folder, bool in_memory) {
  return Mission(std::make_unique<Impl>(Run::resume(folder, in_memory)));
}

void Mission::on_message(std::function<void(const Message&)> listener) {
  impl_->run->listen(std::move(listener));
}

void Mission::on_point(std::function<void(double)> listener) {
  impl_->run->add_foreign(impl_->listeners.emplace_back(*impl_->run, std::move(listener)));
}

void Mission::set(std::string_view variable, const Value& value) {
  impl_->run->set({std::string(variable), value, fmt::format("set(\"{}\")", variable)});
}

void Mission::add_scenario(const std::filesystem::path& file) {
  impl_->run->add_scenario(file);
}

void Mission::add_inputs(const std::filesystem::path& file) {
  impl_->run->add_inputs(file);
}

void Mission::set_stop_time(double stop_time_s) {
  impl_->run->set_stop_time(nanoseconds_of(stop_time_s, "set_stop_time"), "set_stop_time");
}

void Mission::record(const std::vector<std::string>& patterns) {
  impl_->run->record(patterns);
}

void Mission::start_from(std::span<const std::byte> state) {
  impl_->run->start_from(state);
}

std::vector<std::byte> Mission::save_state() {
  if (!impl_->run->busy()) impl_->run->start();
  return impl_->run->save_state();
}

void Mission::start() {
  impl_->run->start();
}

bool Mission::step() {
  return impl_->run->step();
}

void Mission::run() {
  impl_->run->run();
  add_draws(*impl_->run);
}

void Mission::run_until(double time_s) {
  impl_->run->run_until(nanoseconds_of(time_s, "run_until"));
}

void Mission::close() noexcept {
  if (impl_) impl_->run->close();
}

void Mission::interrupt() noexcept {
  impl_->run->interrupt();
}

void Mission::reset() {
  auto& impl = *impl_;
  if (impl.config.empty() || impl.run->busy()) {
    throw InputError(ErrorCode::wrong_call_order, !impl.config.empty()
                                                      ? "reset() was called from a listener, in the middle of a step"
                                                      : "reset(): this mission was resumed from a checkpoint");
  }
  impl.run->close();  // unlocks the results folder
  impl.run = std::make_unique<Run>(impl.config, impl.options, impl.run->library());
  impl.listeners.clear();
}

void Mission::load() {
  impl_->run->load();
}

std::vector<Leftover> Mission::free_instances() {
  return impl_->run->free_instances();
}

RunState Mission::state() const {
  return impl_->run->state();
}

double Mission::time_s() const {
  return impl_->run->time_s();
}

double Mission::step_s() const {
  return to_seconds(impl_->run->system().step);
}

double Mission::stop_time_s() const {
  return impl_->run->system().grid().time_s(impl_->run->system().stop_time_ns);
}

bool Mission::ended() const {
  return state() == RunState::ended || state() == RunState::failed;
}

std::string Mission::outcome() const {
  return impl_->run->outcome();
}

std::optional<EndReason> Mission::end_reason() const {
  return impl_->run->report().end_reason;
}

std::string Mission::end_text() const {
  return impl_->run->report().end_text;
}

std::string Mission::error() const {
  return impl_->run->report().error;
}

std::string Mission::summary() const {
  return impl_->run->summary().dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

double Mission::value(std::string_view variable) {
  const auto [instance, found] = impl_->find(variable);
  const auto kind = kind_of(found->type);
  if (kind == ValueKind::string || kind == ValueKind::binary) {
    throw InputError(ErrorCode::wrong_type,
                     fmt::format("'{}' is a {}; read it with text()", variable, modeldesc::to_string(found->type)));
  }
  if (kind == ValueKind::clock) {
    throw InputError(ErrorCode::wrong_type, fmt::format("'{}' is a Clock, which has no value", variable));
  }
  const auto value = impl_->read(instance, *found, "value()");
  if (const auto* real = std::get_if<double>(&value)) return *real;
  const auto number = std::get<std::int64_t>(value);
  return kind == ValueKind::boolean ? (number != 0 ? 1 : 0) : number_of(found->type, number);
}

std::string Mission::text(std::string_view variable) {
  const auto [instance, found] = impl_->find(variable);
  const bool binary = found->type == Type::binary;
  if (found->type != Type::string && !binary) {
    throw InputError(ErrorCode::wrong_type, fmt::format("'{}' is not a text; read it with value()", variable));
  }
  const auto value = std::get<std::string>(impl_->read(instance, *found, "text()"));
  return binary ? hexadecimal(value) : valid_utf8(value);
}

void Mission::write(std::string_view variable, double value) {
  if (!impl_->run->busy()) impl_->run->start();
  static_cast<void>(write_variable(*impl_->run, variable, value, fmt::format("write(\"{}\")", variable)));
}

std::vector<std::string> Mission::variables() {
  std::vector<std::string> names;
  for (const auto& one : impl_->run->memory().series()) names.push_back(one.name);
  return names;
}

std::vector<double> Mission::times() {
  return impl_->run->memory().times_s();
}

Series Mission::series(std::string_view variable) {
  const auto* found = impl_->run->memory().find(variable);
  if (found == nullptr) {
    throw InputError(ErrorCode::unknown_name,
                     fmt::format("'{}' is not recorded. {}; choose variables with record() before the start", variable,
                                 suggest(variable, variables())));
  }
  return *found;
}

std::vector<Series> Mission::series() {
  return impl_->run->memory().series();
}

class InterruptOnSignals::Guard {
 public:
  Guard(std::atomic<bool>& flag, bool raise_again)
      : guard(flag, raise_again ? SignalGuard::Afterwards::raise : SignalGuard::Afterwards::nothing) {}
  SignalGuard guard;
};

InterruptOnSignals::InterruptOnSignals(Mission& mission, bool raise_again)
    : guard_(std::make_unique<Guard>(mission.impl_->run->interrupt_flag(), raise_again)) {}
InterruptOnSignals::~InterruptOnSignals() = default;

int InterruptOnSignals::signal() const noexcept {
  return guard_->guard.signal();
}

std::string_view version() noexcept {
  return MEBOTS_VERSION;
}

}  // namespace mebots
