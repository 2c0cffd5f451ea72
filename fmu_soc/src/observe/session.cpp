// SPDX-License-Identifier: Apache-2.0
#include "observe/session.hpp"

namespace mebots::soc::observe {

Session::Session(const Requests& requests, Soc& soc) : soc_(soc) {
  if (requests.trace) observers_.add(trace_.emplace(requests.names.trace, *requests.trace, requests.trace_columns));
  if (requests.profile) observers_.add(profile_.emplace(requests.names.profile, *requests.profile, soc));
  if (requests.power_trace) soc.listen(&power_trace_.emplace(requests.names.power_trace, *requests.power_trace, soc));
  if (requests.gdb_port) {
    observers_.add(gdb_.emplace(*requests.gdb_port, soc, requests.gdb_kill, requests.announce));
  }
  if (!observers_.empty()) soc.hart().observe(&observers_);
}

Session::~Session() {
  soc_.hart().observe(nullptr);
  soc_.listen(nullptr);
}

void Session::add(Observer& observer) {
  observers_.add(observer);
  soc_.hart().observe(&observers_);
}

void Session::remove(Observer& observer) {
  observers_.remove(observer);
  if (observers_.empty()) soc_.hart().observe(nullptr);
}

void Session::restored() {
  if (profile_) profile_->restored();
  if (power_trace_) power_trace_->restored();
}

void Session::finish(int exit_code) {
  if (gdb_) gdb_->finish(exit_code);
  if (trace_) trace_->close();
  if (profile_) profile_->finish();
  if (power_trace_) power_trace_->finish();
}

}  // namespace mebots::soc::observe
