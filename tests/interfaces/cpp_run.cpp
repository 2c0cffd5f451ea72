// SPDX-License-Identifier: Apache-2.0
// Runs a config through the C++ interface, for interfaces_test.py. Prints four lines: error code, state, outcome,
// error.
//   cpp_run CONFIG OUT [--set NAME=NUMBER|TEXT] [--scenario FILE] [--stop-time S] [--checkpoint-every S] [--isolate]
//                      [--statistics] [--step-by-step]
//   cpp_run --resume OUT
#include <mebots/run.hpp>

#include <charconv>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace {

struct Request {
  mebots::RunOptions options;
  std::vector<std::pair<std::string, mebots::Value>> settings;
  bool step_by_step = false;
};

mebots::Value value_of(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  const auto* const end = text.data() + text.size();
  std::int64_t whole = 0;
  if (std::from_chars(text.data(), end, whole).ptr == end && !text.empty()) return whole;
  double number = 0;
  if (std::from_chars(text.data(), end, number).ptr == end && !text.empty()) return number;
  return text;
}

Request read(const std::vector<std::string>& words) {
  Request request;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto& word = words[i];
    if (word == "--isolate") request.options.isolate = true;
    if (word == "--statistics") request.options.statistics = true;
    if (word == "--step-by-step") request.step_by_step = true;
    if (word == "--scenario") request.options.scenarios.emplace_back(words.at(++i));
    if (word == "--stop-time") request.options.stop_time_s = std::stod(words.at(++i));
    if (word == "--checkpoint-every") request.options.checkpoint_every_s = std::stod(words.at(++i));
    if (word == "--set") {
      const auto& text = words.at(++i);
      const auto equals = text.find('=');
      request.settings.emplace_back(text.substr(0, equals), value_of(text.substr(equals + 1)));
    }
  }
  return request;
}

mebots::Mission open(const std::vector<std::string>& words, const Request& request) {
  if (words[0] == "--resume") return mebots::Mission::resume(words.at(1));
  auto options = request.options;
  options.out = words.at(1);
  mebots::Mission mission(words[0], options);
  for (const auto& [name, value] : request.settings) mission.set(name, value);
  return mission;
}

void print(const char* code, const char* state, const std::string& outcome, const std::string& error) {
  std::printf("%s\n%s\n%s\n%s\n", code, state, outcome.c_str(), error.c_str());
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  const auto request = read(words);
  try {
    auto mission = open(words, request);
    const mebots::InterruptOnSignals guard(mission);
    const char* code = "";
    try {
      if (request.step_by_step) {
        while (mission.step()) {
        }
      } else {
        mission.run();
      }
    } catch (const mebots::Error& error) {
      code = mebots::name_of(error.code()).data();
    }
    print(code, mebots::name_of(mission.state()).data(), mission.outcome(), mission.error());
    return 0;
  } catch (const mebots::InputError& error) {
    print(mebots::name_of(error.code()).data(), "refused", "", error.what());
    return 2;
  }
}
