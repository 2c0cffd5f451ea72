// SPDX-License-Identifier: Apache-2.0
#include "live_run.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/input_error.hpp"
#include "mebots/parsed_number.hpp"
#include "message/message_text.hpp"
#include "report/page.hpp"
#include "report/result_table.hpp"
#include "run/json_value.hpp"
#include "run/run.hpp"
#include "run/system_file.hpp"
#include "server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace mebots::live {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr auto kPatience = 20s;     ///< maximum time to wait for an answer; a step may take long
constexpr auto kClientLinger = 3s;  ///< maximum time to wait at the end for active clients that are not pages
constexpr auto kLookedLately = 5s;  ///< maximum age of the last request of an active client
/// Maximum time to wait for open pages at the end of the run. On a busy machine, drawing a page may take many seconds.
constexpr auto kPageLinger = 30s;
/// Maximum age of the last request of an open page. This limit matters only for killed browsers, because a page reports
/// when it closes. The limit is above a minute, because browsers limit hidden pages to one request per minute.
constexpr auto kPageOpen = 70s;
constexpr std::string_view kLeaveOrder = "leave=";
constexpr auto kHeldNap = 50ms;  ///< time between checks of the interrupt flag during a pause
constexpr std::string_view kPaceOrder = "pace=";

/// Returns the rows in memory from `first` on as a table. Like a table from a file, it keeps only the extremes of each
/// span if there are many rows.
master::report::ResultTable table_of(const master::MemorySink& memory, std::size_t first) {
  using master::report::ResultTable;
  const auto& times = memory.times_s();
  ResultTable table;
  table.rows = times.size();
  table.columns.push_back({"time", "s", {}});
  for (const auto& series : memory.series()) {
    table.columns.push_back({series.name, series.unit.empty() ? "-" : series.unit, {}});
  }
  const auto width = table.columns.size();
  first = std::min(first, table.rows);
  table.span = ResultTable::span_of(table.rows - first, width);
  master::report::Thinner thinner(width, table.span);
  std::vector<double> row(width);
  for (auto at = first; at < table.rows; ++at) {
    row[0] = times[at];
    for (std::size_t i = 1; i < width; ++i) row[i] = memory.series()[i - 1].values[at];
    thinner.add(row);
  }
  thinner.finish();
  for (std::size_t i = 0; i < width; ++i) table.columns[i].values = std::move(thinner.values()[i]);
  return table;
}

}  // namespace

LiveRun::LiveRun(master::Run& run, const LiveOptions& options)
    : run_(&run), for_browser_(options.for_browser), pace_(options.pace) {
  const auto page = std::make_shared<const std::string>(
      master::report::make_live_page(master::report::read_page_parts(), run.system().name));
  const auto in_run = [this](Mailbox::Question question) {
    return mailbox_.ask(std::move(question), std::chrono::duration_cast<std::chrono::milliseconds>(kPatience));
  };
  Server::Answers answers;
  answers.page = [page] { return *page; };
  answers.data = [this, in_run](const Known& known) {
    // shared, because the run may answer after the querying thread has stopped waiting
    const auto has_end = std::make_shared<bool>(false);
    auto body = in_run([this, known, has_end] {
      *has_end = ended_;
      return data(known);
    });
    Server::Answer answer{std::move(body), [] {}};
    if (*has_end) answer.after_sending = [this, page = known.page] { note_end_sent(page); };
    return answer;
  };
  answers.control = [this, in_run](const std::string& order) {
    return in_run([this, order] { return control(order); });
  };
  answers.set = [this, in_run](const std::string& variable, const std::string& value) {
    return in_run([this, variable, value] { return set(variable, value); });
  };
  run.listen([log = log_](const Message& message) { *log += master::message_text(message) + "\n"; });
  server_ = std::make_unique<Server>(options.port, answers);
  address_ = server_->address();
}

LiveRun::~LiveRun() {
  mailbox_.close();
}

void LiveRun::run() {
  run_->start();
  // Performs the first step before users can set values, because scenario entries at the start time would also affect
  // initialisation.
  set_pace(pace_);
  if (run_->step()) step_until_the_end();
  ended_ = true;
}

void LiveRun::step_until_the_end() {
  for (;;) {
    mailbox_.answer_all();
    const bool interrupted = run_->interrupt_flag().load(std::memory_order_relaxed);
    if (must_wait() && !interrupted) {
      mailbox_.wait_and_answer(kHeldNap);
      set_pace(pace_);
      continue;
    }
    const auto due = until_due();
    if (due > Clock::duration::zero() && !one_step_ && !interrupted) {
      mailbox_.wait_and_answer(std::min(std::chrono::duration_cast<std::chrono::milliseconds>(due) + 1ms,
                                        std::chrono::milliseconds(kHeldNap)));
      continue;
    }
    one_step_ = false;
    if (!run_->step()) return;
  }
}

bool LiveRun::must_wait() const {
  return for_browser_ || (held_ && !one_step_);
}

void LiveRun::set_pace(double pace) {
  pace_ = pace;
  paced_since_ = Clock::now();
  paced_from_s_ = run_->time_s();
}

Clock::duration LiveRun::until_due() const {
  if (pace_ == 0) return Clock::duration::zero();
  const std::chrono::duration<double> after_start((run_->time_s() - paced_from_s_) / pace_);
  return paced_since_ + std::chrono::duration_cast<Clock::duration>(after_start) - Clock::now();
}

void LiveRun::keep() {
  while (!run_->interrupt_flag().load(std::memory_order_relaxed)) mailbox_.wait_and_answer(kHeldNap);
}

void LiveRun::linger() {
  const auto end = Clock::now();
  const auto& interrupted = run_->interrupt_flag();
  while (is_awaited(end) && !interrupted.load(std::memory_order_relaxed)) mailbox_.wait_and_answer(kHeldNap);
}

bool LiveRun::is_awaited(Clock::time_point end) const {
  const auto waited = Clock::now() - end;
  if (waited < kPageLinger && pages_.any_since(end - kPageOpen)) return true;
  return !end_sent_ && waited < kClientLinger && end - last_look_ < kLookedLately;
}

void LiveRun::note_request(const std::string& page) {
  if (page.empty()) {
    last_look_ = Clock::now();
  } else {
    pages_.note_request(page);
  }
}

void LiveRun::note_end_sent(const std::string& page) {
  if (page.empty()) {
    end_sent_ = true;
  } else {
    pages_.remove(page);
  }
}

std::string LiveRun::data(const Known& known) {
  note_request(known.page);
  for_browser_ = false;
  master::report::RunFolder folder;
  folder.live = {{"held", held_},
                 {"pace", pace_},
                 {"ended", ended_},
                 {"known", {{"rows", known.rows}, {"pictures", known.pictures}, {"log", known.log}}},
                 {"log", log_->size()}};
  if (known.rows == 0 || ended_) add_constant_data(folder);
  folder.name = run_->system().name;
  folder.pictures = master::report::read_pictures(run_->options().out, known.pictures);
  folder.results = table_of(run_->memory(), known.rows);
  folder.summary = run_->summary();
  folder.log = log_->substr(std::min(known.log, log_->size()));
  return master::report::payload_of(std::span(&folder, 1));
}

/// Adds the data that do not depend on the rows. A browser receives them in its first answer, and again at the end of
/// the run, because the profiles are written only then.
void LiveRun::add_constant_data(master::report::RunFolder& folder) const {
  auto side = master::report::read_side_files(run_->options().out);
  folder.scene = std::move(side.scene);
  folder.profiles = std::move(side.profiles);
  folder.system = master::system_json(run_->resolved());
  folder.live["stop_time"] = run_->system().grid().time_s(run_->system().stop_time_ns);
  folder.live["settable"] = master::writable_variables(run_->resolved());
}

std::string LiveRun::control(const std::string& order) {
  if (order == "hold") {
    held_ = true;
  } else if (order == "go") {
    held_ = false;
  } else if (order == "step") {
    held_ = true;
    one_step_ = true;
  } else if (order.starts_with(kPaceOrder)) {
    const auto pace = parsed_number<double>(order.substr(kPaceOrder.size()));
    if (!pace || !(*pace >= 0) || *pace > kFastestPace) {
      throw InputError(ErrorCode::invalid_argument,
                       fmt::format("'{}': the pace must be from 0 (as fast as possible) to {}", order, kFastestPace));
    }
    set_pace(*pace);
  } else if (order.starts_with(kLeaveOrder)) {
    pages_.remove(order.substr(kLeaveOrder.size()));
  } else {
    throw InputError(ErrorCode::invalid_argument,
                     fmt::format("'{}' must be hold, step, go, pace=NUMBER or leave=PAGE", order));
  }
  return Json({{"held", held_}}).dump();
}

std::string LiveRun::set(const std::string& variable, const std::string& value) {
  const auto number = parsed_number<double>(value);
  if (!number) {
    throw InputError(ErrorCode::invalid_value, fmt::format("'{}' is not a number for {}", value, variable));
  }
  run_->set_by_hand(variable, *number);
  return Json({{"at", run_->time_s()}}).dump();
}

std::string Mailbox::ask(Question question, std::chrono::milliseconds patience) {
  std::packaged_task<std::string()> task(std::move(question));
  auto answer = task.get_future();
  {
    const std::lock_guard lock(mutex_);
    if (closed_) throw NoAnswer("the run is over");
    waiting_.push_back(std::move(task));
    any_.store(true, std::memory_order_release);
  }
  arrived_.notify_one();
  if (answer.wait_for(patience) != std::future_status::ready) throw NoAnswer("the run does not respond");
  try {
    return answer.get();
  } catch (const std::future_error&) {  // close() discarded the query
    throw NoAnswer("the run is over");
  }
}

void Mailbox::answer_all() {
  if (!any_.load(std::memory_order_acquire)) return;
  std::deque<std::packaged_task<std::string()>> tasks;
  {
    const std::lock_guard lock(mutex_);
    tasks.swap(waiting_);
    any_.store(false, std::memory_order_release);
  }
  for (auto& task : tasks) task();
}

void Mailbox::wait_and_answer(std::chrono::milliseconds patience) {
  {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, patience, [this] { return !waiting_.empty(); });
  }
  answer_all();
}

void Mailbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  waiting_.clear();  // destroys the promises, so that ask() throws
}

}  // namespace mebots::live
