// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/instance_calls.hpp"

#include "base/time.hpp"
#include "mebots/assert.hpp"
#include "message/message_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <limits>

namespace mebots::master {
namespace {

constexpr std::size_t kLastMessages = 5;

Severity severity_of(int status) {
  if (status == InstanceCalls::kOk) return Severity::info;
  const bool is_warning =
      status == InstanceCalls::kWarning || status == InstanceCalls::kDiscard || status == InstanceCalls::kPending;
  return is_warning ? Severity::warning : Severity::error;
}

modeldesc::Type type_of_letter(char letter) {
  switch (letter) {
    case 'r':
      return modeldesc::Type::real;
    case 'i':
      return modeldesc::Type::integer;
    case 'b':
      return modeldesc::Type::boolean;
    default:
      return modeldesc::Type::string;
  }
}

}  // namespace

InstanceCalls::InstanceCalls(std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories,
                             MessageSink& messages, const TimeGrid& grid, StatusName status_name)
    : name_(std::move(name)),
      fmu_(std::move(fmu)),
      log_categories_(std::move(log_categories)),
      sink_(&messages),
      grid_(grid),
      status_name_(status_name),
      target_(*this, name_) {}

InstanceCalls::~InstanceCalls() {
  if (instance_ != nullptr && !is_gone_) target_.keep_environment();
}

void InstanceCalls::instantiate(const char* function, const std::function<void*()>& make) {
  const auto at_load = fmu_->take_changes_at_load();
  is_watched_ = fmu_->enter();
  watched_step_ = is_watched_ ? 1 : 0;
  if (const auto found = fmu_->floats_at_load()) report_floats(*found, "loading its library");
  report_process_changes(at_load, "loading its library");
  instantiate_again(function, make);
  MEBOTS_ASSERT(!unusable_);
  deliver_held();
}

void InstanceCalls::instantiate_again(const char* function, const std::function<void*()>& make) {
  target_.set_library(fmu_->library());
  watched(function, [&] { instance_ = in_scope(function, [&] { return make(); }); });
  if (instance_ == nullptr) fail(function, "returned no instance");
  target_.set_component(instance_);
}

/// Frees the instance. A crash in this call ends the whole process.
std::optional<std::string> InstanceCalls::free_instance(const char* function, const std::function<void()>& free) {
  if (std::exchange(freed_, true)) return std::nullopt;
  std::optional<std::string> fault;
  try {
    if (instance_ != nullptr && !unusable_ && !fmu_->corrupted()) {
      watched(function, [&] { free(); });
      is_gone_ = !unusable_;
    }
    deliver_held();
  } catch (const SlaveError& error) {
    fault = error.what();
    sink_->message({name_, Severity::error, "notice", *fault, time_ns_});
  }
  const auto threads = fmu_->leave();
  if (threads == 0) return fault;
  warn(
      fmt::format("{} that started after the FMU {} was loaded still {}, so its code stays in memory until "
                  "the program ends",
                  threads == 1 ? "a thread" : fmt::format("{} threads", threads), fmu_->archive().filename().string(),
                  threads == 1 ? "runs" : "run"));
  return fault;
}

void InstanceCalls::leave_by_exception(const char* name, const ForeignException& exception) {
  leave(name);
  unusable_ = true;  // the exception has aborted a function of the FMU
  fail(name, exception.what());
}

void InstanceCalls::report_floats(const FloatEnvironment& found, const char* where) {
  if (!fmu_->claim_float_report()) return;
  const auto text = fmt::format(
      "the FMU {} changed the floating-point environment of its thread in {}: {}; the change applies to calls of the "
      "instance only",
      fmu_->archive().filename().string(), where, difference_text(found, floats_));
  sink_->message({name_, Severity::warning, "notice", text, time_ns_});
}

void InstanceCalls::report_process_changes(const std::vector<std::string>& changes, const char* where) {
  if (changes.empty()) return;
  const auto text = fmt::format("the FMU {} changed the whole process in {}: {}", fmu_->archive().filename().string(),
                                where, fmt::join(changes, "; "));
  sink_->message({name_, Severity::warning, "notice", text, time_ns_});
}

std::vector<const char*> InstanceCalls::chosen_categories() const {
  static constexpr std::string_view kAlways[] = {"logStatusWarning", "logStatusDiscard", "logStatusError",
                                                 "logStatusFatal"};
  if (std::ranges::find(log_categories_, "*") != log_categories_.end()) return {};
  // If the FMU declares none of these categories, the list is empty and the FMU logs everything. is_shown() then
  // selects the messages.
  std::vector<const char*> chosen;
  for (const auto& category : description().log_categories) {
    if (std::ranges::find(log_categories_, category.name) != log_categories_.end() ||
        std::ranges::find(kAlways, category.name) != std::end(kAlways)) {
      chosen.push_back(category.name.c_str());
    }
  }
  return chosen;
}

bool InstanceCalls::is_shown(Severity severity, std::string_view category) const {
  return severity != Severity::info || std::ranges::any_of(log_categories_, [&](const std::string& wanted) {
           return wanted == "*" || wanted == category;
         });
}

void InstanceCalls::logged(LoggerCall call) {
  const std::lock_guard lock(log_mutex_);
  const auto severity = severity_of(call.status);
  auto text = with_names(call.text);
  if (severity != Severity::info) {
    last_messages_.push_back(indented_lines(text));
    if (last_messages_.size() > kLastMessages) last_messages_.pop_front();
  }
  if (!is_shown(severity, call.category)) return;
  any_held_ = true;
  if (!limit_.take(text.size() + call.category.size())) return;
  if (call.in_call && severity != Severity::error) {
    sink_->message({name_, severity, call.category, text, time_ns_});
    return;
  }
  held_.push_back({severity, std::move(call.category), std::move(text)});
}

std::string InstanceCalls::with_names(std::string_view text) const {
  // In messages of FMI 1.0 and 2.0, "#r12#" means the name of the Real with value reference 12, and "##" means "#".
  std::string result;
  std::size_t at = 0;
  while (at < text.size()) {
    const auto hash = text.find('#', at);
    result += text.substr(at, hash - at);
    if (hash == std::string_view::npos) break;
    const auto end = text.find('#', hash + 1);
    if (end == std::string_view::npos) {
      result += text.substr(hash);
      break;
    }
    const auto inside = text.substr(hash + 1, end - hash - 1);
    const auto digits = inside.empty() ? inside : inside.substr(1);
    const bool reference = inside.size() >= 2 && inside.size() < 12 &&
                           std::string_view("ribs").find(inside[0]) != std::string_view::npos &&
                           std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (inside.empty()) {
      result += '#';
    } else if (reference) {
      const auto number = std::stoull(std::string(digits));
      const auto& variables = description().variables;
      const auto found = std::find_if(variables.begin(), variables.end(), [&](const modeldesc::Variable& variable) {
        const auto type = variable.type == modeldesc::Type::enumeration ? modeldesc::Type::integer : variable.type;
        return variable.value_reference == number && type == type_of_letter(inside[0]);
      });
      result += found == variables.end() ? std::string(inside) : found->name;
    } else {
      result += '#';
      at = hash + 1;
      continue;
    }
    at = end + 1;
  }
  return result;
}

std::string InstanceCalls::string_name(std::uint32_t reference) const {
  const auto& variables = description().variables;
  const auto found = std::ranges::find_if(variables, [&](const modeldesc::Variable& variable) {
    return variable.type == modeldesc::Type::string && variable.value_reference == reference;
  });
  return found == variables.end() ? fmt::format("reference {}", reference) : found->name;
}

void InstanceCalls::copy_texts(const char* function, std::span<const std::uint32_t> references,
                               std::span<const char* const> addresses, std::span<std::string> values) {
  for (std::size_t i = 0; i < addresses.size(); ++i) {
    const auto text = read_text(addresses[i], std::numeric_limits<std::size_t>::max());
    if (!text && addresses[i] != nullptr) {
      fail(function, fmt::format("returned the address {} for the text of {}, and this memory cannot be read",
                                 fmt::ptr(addresses[i]), string_name(references[i])));
    }
    values[i] = text.value_or("");
  }
}

void InstanceCalls::deliver_held() {
  const std::lock_guard lock(log_mutex_);
  deliver_all_but(0);
}

/// Drops the last `last` stored messages and delivers the others. The caller must hold the mutex.
void InstanceCalls::deliver_all_but(std::size_t last) {
  held_.resize(held_.size() - std::min(held_.size(), last));
  for (const auto& held : held_) sink_->message({name_, held.severity, held.category, held.text, time_ns_});
  held_.clear();
  if (const auto notice = limit_.restart()) sink_->message({name_, Severity::warning, "notice", *notice, time_ns_});
  any_held_ = false;
}

std::string InstanceCalls::last_messages() const {
  if (last_messages_.empty()) return "The FMU logged nothing about it.";
  return fmt::format("The FMU logged: {}", fmt::join(last_messages_, "; "));
}

void InstanceCalls::fail(const char* function, std::string_view what) {
  const std::lock_guard lock(log_mutex_);
  const auto is_quoted = [this](const Held& held) {
    return std::ranges::find(last_messages_, indented_lines(held.text)) != last_messages_.end();
  };
  const auto first_quoted = std::find_if_not(held_.rbegin(), held_.rend(), is_quoted).base();
  // The text of the exception contains the messages that are dropped here.
  deliver_all_but(static_cast<std::size_t>(held_.end() - first_quoted));
  throw SlaveError(
      fmt::format("instance '{}' at {} s: {} {}. {}", name_, to_seconds(time_ns_), function, what, last_messages()));
}

void InstanceCalls::check(int status, const char* function) {
  if (status == kOk || status == kWarning) {
    if (any_held_.load(std::memory_order_relaxed)) deliver_held();
    return;
  }
  if (status == kFatal) {
    unusable_ = true;
    fmu_->set_corrupted();  // the standard applies this to all instances of the FMU
  }
  fail(function, fmt::format("returned {}", status_name_(status)));
}

}  // namespace mebots::master
