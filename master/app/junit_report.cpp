// SPDX-License-Identifier: Apache-2.0
#include "junit_report.hpp"

#include "progress.hpp"

#include "message/message_text.hpp"
#include "record/sink/output_file.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <sstream>

namespace mebots::app {
namespace {

/// Makes a text valid for XML 1.0: replaces control characters by spaces, and repairs invalid UTF-8.
std::string printable(const std::string& raw) {
  auto text = master::valid_utf8(raw);
  for (auto& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') c = ' ';
  }
  return text;
}

JunitCase case_of(const master::Run* run, const std::vector<std::string>& expected, const std::string& error) {
  JunitCase result;
  if (!error.empty() || run == nullptr) {
    result.outcome = JunitOutcome::error;
    result.message = error;
  } else {
    const bool interrupted = run->report().end_reason == EndReason::interrupted;
    result.message = interrupted ? run->report().end_text : why_unexpected(*run, expected);
    if (!result.message.empty()) result.outcome = JunitOutcome::failure;
  }
  result.name = run != nullptr ? run->system().name : std::string("mebots run");
  if (run == nullptr) return result;
  result.time_s = run->report().wall.open_s + run->report().wall.simulating_s();
  result.out = fmt::format("outcome: {}\nsimulated: {} s\n", run->outcome(), run->time_s());
  return result;
}

void append_case(pugi::xml_node suite, const std::string& classname, const JunitCase& one) {
  auto test = suite.append_child("testcase");
  test.append_attribute("classname") = printable(classname).c_str();
  test.append_attribute("name") = printable(one.name).c_str();
  test.append_attribute("time") = fmt::format("{:.3f}", one.time_s).c_str();
  if (one.outcome != JunitOutcome::passed) {
    auto element = test.append_child(one.outcome == JunitOutcome::failure ? "failure" : "error");
    element.append_attribute("message") = printable(one.message).c_str();
  }
  if (!one.out.empty()) test.append_child("system-out").text().set(printable(one.out).c_str());
}

}  // namespace

void write_junit(const std::filesystem::path& file, const std::string& classname, const std::vector<JunitCase>& cases) {
  const auto count = [&](JunitOutcome outcome) {
    return static_cast<unsigned>(std::ranges::count(cases, outcome, &JunitCase::outcome));
  };
  double time_s = 0;
  for (const auto& one : cases) time_s += one.time_s;
  pugi::xml_document document;
  auto suite = document.append_child("testsuites").append_child("testsuite");
  suite.append_attribute("name") = printable(classname).c_str();
  suite.append_attribute("tests") = static_cast<unsigned>(cases.size());
  suite.append_attribute("failures") = count(JunitOutcome::failure);
  suite.append_attribute("errors") = count(JunitOutcome::error);
  suite.append_attribute("time") = fmt::format("{:.3f}", time_s).c_str();
  for (const auto& one : cases) append_case(suite, classname, one);
  std::ostringstream text;
  document.save(text, "  ");
  master::OutputFile output(file);
  output.append(text.str());
  output.close();
}

void write_junit(const std::filesystem::path& file, const master::Run* run, const std::vector<std::string>& expected,
                 const std::string& error) {
  write_junit(file, "mebots", {case_of(run, expected, error)});
}

}  // namespace mebots::app
