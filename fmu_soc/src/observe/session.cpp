// SPDX-License-Identifier: Apache-2.0
#include "observe/session.hpp"

#include "mebots/error.hpp"

namespace mebots::soc::observe {

namespace {

void require_hart(const Requests& requests, const Soc& soc) {
  if (requests.pipeline_hart < soc.harts()) return;
  throw Error(fmt::format("{}-hart {}: this chip has harts 0 to {}", requests.names.pipeline, requests.pipeline_hart,
                          soc.harts() - 1));
}

}  // namespace

Session::Session(const Requests& requests, Soc& soc) : soc_(soc), observers_(soc.harts()) {
  if (requests.trace) trace_.emplace(requests.names.trace, *requests.trace, requests.trace_columns, soc.harts());
  if (requests.profile) profile_.emplace(requests.names.profile, *requests.profile, soc);
  if (requests.power_trace) listen(power_trace_.emplace(requests.names.power_trace, *requests.power_trace, soc));
  if (requests.cycle_stack) cycle_stack_.emplace(soc);
  if (requests.coverage) coverage_.emplace(requests.names.coverage, *requests.coverage, soc.program());
  if (requests.pipeline) {
    require_hart(requests, soc);
    pipeline_.emplace(requests.names.pipeline, *requests.pipeline);
  }
  if (requests.gdb_port) gdb_.emplace(*requests.gdb_port, soc, requests.gdb_kill, requests.announce, requests.history);
  for (unsigned number = 0; number < soc.harts(); ++number) {
    if (trace_) observers_[number].add(trace_->hart(number));
    if (profile_) observers_[number].add(profile_->hart(number));
    if (cycle_stack_) observers_[number].add(cycle_stack_->hart(number));
    if (coverage_) observers_[number].add(coverage_->observer());
    if (pipeline_ && number == requests.pipeline_hart) observers_[number].add(*pipeline_);
    if (gdb_) observers_[number].add(gdb_->hart(number));
  }
  for (unsigned number = 0; number < soc.harts(); ++number) attach(number);
}

Session::~Session() {
  for (unsigned number = 0; number < soc_.harts(); ++number) soc_.observe(number, nullptr);
  soc_.listen(nullptr);
}

/// Sets the observer of a hart. If no observer was added, sets null, so that the hart runs at full speed.
void Session::attach(unsigned number) {
  soc_.observe(number, observers_[number].empty() ? nullptr : &observers_[number]);
}

void Session::add(Observer& observer) {
  observers_[0].add(observer);
  attach(0);
}

void Session::remove(Observer& observer) {
  observers_[0].remove(observer);
  attach(0);
}

void Session::listen(StateListener& listener) {
  listeners_.add(listener);
  soc_.listen(&listeners_);
}

void Session::restored() {
  if (profile_) profile_->restored();
  if (power_trace_) power_trace_->restored();
}

void Session::checkpoint() {
  if (gdb_) gdb_->checkpoint();
}

bool Session::rewind() {
  return gdb_ && gdb_->rewind();
}

void Session::stepped() {
  if (profile_) profile_->stepped();
}

void Session::finish(int exit_code) {
  if (gdb_) gdb_->finish(exit_code);
  if (trace_) trace_->close();
  if (profile_) profile_->finish();
  if (power_trace_) power_trace_->finish();
  if (cycle_stack_) cycle_stack_->finish();
  if (coverage_) coverage_->finish();
  if (pipeline_) pipeline_->close();
}

}  // namespace mebots::soc::observe
