// SPDX-License-Identifier: Apache-2.0
#include "run/live_scenario.hpp"

#include "base/input_text.hpp"
#include "base/time.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "record/sink/output_file.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

using Json = nlohmann::ordered_json;

std::int64_t time_of(const Json& entry) {
  return nanoseconds_of(entry.at("from").get<double>(), kLiveScenarioFile);
}

}  // namespace

void LiveScenario::resume(std::int64_t time_ns) {
  if (!is_there(file_)) return;
  try {
    entries_ = Json::parse(input_text(file_)).at("scenario");
    while (done_ < entries_.size() && time_of(entries_[done_]) < time_ns) ++done_;
  } catch (const Json::exception& error) {
    throw InputError(
        ErrorCode::syntax_error,
        fmt::format("{}: this is not the list of values that the run wrote ({}). Remove the file to resume "
                    "without the values that were set by hand after the checkpoint",
                    file_.string(), error.what()));
  }
}

void LiveScenario::add(std::string_view variable, const Json& value, std::int64_t time_ns) {
  const Json entry = {{"text", "set by hand"}, {"variable", variable}, {"set", value}, {"from", to_seconds(time_ns)}};
  entries_.insert(entries_.begin() + static_cast<std::ptrdiff_t>(done_), entry);
  ++done_;
  write_whole(file_, Json({{"text", "Values set by hand during the run"}, {"scenario", entries_}}).dump(2) + "\n");
}

std::vector<LiveScenario::Entry> LiveScenario::due(std::int64_t time_ns) {
  std::vector<Entry> due;
  for (; done_ < entries_.size() && time_of(entries_[done_]) <= time_ns; ++done_) {
    const auto& entry = entries_[done_];
    const auto& value = entry.at("set");
    due.push_back({entry.at("variable").get<std::string>(),
                   value.is_boolean() ? (value.get<bool>() ? 1 : 0) : value.get<double>()});
  }
  return due;
}

}  // namespace mebots::master
