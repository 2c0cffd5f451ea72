// SPDX-License-Identifier: Apache-2.0
#include "junit_report.hpp"

#include "run_texts.hpp"

#include "base/time.hpp"
#include "message/plain_text.hpp"
#include "sink/output_file.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <sstream>
#include <utility>

namespace mebots::app {
namespace {

/// A text that XML 1.0 can carry: control characters become spaces, bytes that are not UTF-8 are replaced.
std::string printable(const std::string& raw) {
  auto text = master::valid_utf8(raw);
  for (auto& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') c = ' ';
  }
  return text;
}

struct Verdict {
  const char* element = nullptr;  // null = passed
  std::string text;
};

Verdict verdict_of(const master::Run* run, const std::vector<std::string>& expected, const std::string& error) {
  if (!error.empty() || run == nullptr) return {"error", error};
  if (run->report().end_reason == EndReason::interrupted) return {"failure", run->report().end_text};
  auto why = why_unexpected(*run, expected);
  if (why.empty()) return {};
  return {"failure", std::move(why)};
}

}  // namespace

void write_junit(const std::filesystem::path& file, const master::Run* run, const std::vector<std::string>& expected,
                 const std::string& error) {
  const auto verdict = verdict_of(run, expected, error);
  const auto is = [&](std::string_view element) { return verdict.element != nullptr && verdict.element == element; };
  const auto& wall = run != nullptr ? run->report().wall : master::WallTimes{};
  const auto time = fmt::format("{:.3f}", wall.open_s + wall.simulating_s());
  const auto name = run != nullptr ? run->system().name : std::string("mebots run");

  pugi::xml_document document;
  auto suite = document.append_child("testsuites").append_child("testsuite");
  suite.append_attribute("name") = "mebots";
  suite.append_attribute("tests") = 1;
  suite.append_attribute("failures") = is("failure") ? 1 : 0;
  suite.append_attribute("errors") = is("error") ? 1 : 0;
  suite.append_attribute("time") = time.c_str();
  auto test = suite.append_child("testcase");
  test.append_attribute("classname") = "mebots";
  test.append_attribute("name") = name.c_str();
  test.append_attribute("time") = time.c_str();
  if (verdict.element != nullptr) {
    auto element = test.append_child(verdict.element);
    element.append_attribute("message") = printable(verdict.text).c_str();
  }
  if (run != nullptr) {
    auto out = fmt::format("outcome: {}\nsimulated: {} s\n", run->outcome(), master::to_seconds(run->time_ns()));
    test.append_child("system-out").text().set(printable(out).c_str());
  }
  std::ostringstream text;
  document.save(text, "  ");
  master::OutputFile output(file);
  output.append(text.str());
  output.close();
}

}  // namespace mebots::app
