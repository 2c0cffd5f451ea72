// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/run_folder.hpp"
#include "run/run.hpp"

#include <nlohmann/json.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>

namespace mebots::live {

/// Queries from other threads to the thread that steps a run. Only that thread accesses the run: it takes the queries
/// between two steps and answers them there.
class Mailbox {
 public:
  using Question = std::function<std::string()>;

  /// From any thread: what `question` returned, or throws, in the run's thread. Throws std::exception if no
  /// answer arrives within `patience`, and after close().
  std::string ask(Question question, std::chrono::milliseconds patience);

  /// From the run's thread: answers what is there. Costs one atomic read when there is nothing.
  void answer_all();
  /// The same, after waiting for a question for at most `patience`.
  void wait_and_answer(std::chrono::milliseconds patience);
  /// Ends all queries: each waiting thread gets an exception.
  void close();

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<std::packaged_task<std::string()>> waiting_;
  std::atomic<bool> any_{false};
  bool closed_ = false;
};

constexpr double kFastestPace = 1e6;

struct LiveOptions {
  int port = 0;              ///< 0: a free one
  bool for_browser = false;  ///< the first step waits until a browser has fetched the data
  double pace = 0;           ///< simulated seconds per second of wall time; 0: as fast as possible
};

/// Steps a run to its end while a browser on this machine may look at it, hold it, and set its free inputs.
///
/// The page is served on the loopback address under a token that nobody can guess; requests of other hosts and origins
/// are refused. Whoever only looks changes no bit of the results: the run's thread reads what is recorded anyway. What
/// is set is kept as a scenario (live_scenario.json in the results folder), with which the run repeats itself.
class LiveRun {
 public:
  /// `run` is not started, has a folder and keeps its rows in memory (RunOptions::in_memory); it must outlive this
  /// object. Throws InputError when the port is taken, Error for a mebots without pages.
  LiveRun(master::Run& run, const LiveOptions& options);
  ~LiveRun();
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  /// What to open in a browser.
  const std::string& address() const { return address_; }
  /// Steps to the end.
  void run();
  /// After the end: waits a moment for browsers that sent a request lately, so that they get the last rows.
  void linger();
  /// After the end: serves the page until the run's interrupt flag is set.
  void keep();

  class Server;

 private:
  /// What a browser has already; nothing of it: all there is.
  struct Known {
    std::size_t rows = 0;
    std::size_t pictures = 0;  // of each camera
    std::size_t log = 0;       // bytes
  };

  void step_until_the_end();
  /// True until the next step may be taken.
  bool must_wait() const;
  void set_pace(double pace);
  /// Wall time until the next step is due at the pace.
  std::chrono::steady_clock::duration until_due() const;
  std::string data(const Known& known);
  void add_constant_data(master::report::RunFolder& folder) const;
  std::string control(const std::string& order);
  std::string set(const std::string& variable, const std::string& value);
  void save_scenario() const;

  master::Run* run_;
  std::string address_;
  std::shared_ptr<std::string> log_ = std::make_shared<std::string>();  // the run's listener may outlive this
  Mailbox mailbox_;
  bool for_browser_ = false;
  double pace_ = 0;
  double paced_from_s_ = 0;  ///< simulated time at paced_since_
  std::chrono::steady_clock::time_point paced_since_{};
  bool held_ = false;
  bool one_step_ = false;
  bool ended_ = false;
  bool end_seen_ = false;
  std::chrono::steady_clock::time_point last_look_{};
  nlohmann::ordered_json scenario_ = nlohmann::ordered_json::array();
  std::unique_ptr<Server> server_;
};

}  // namespace mebots::live
