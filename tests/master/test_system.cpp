// SPDX-License-Identifier: Apache-2.0
#include "test_system.hpp"
#include "io/config/load_system.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <sstream>

namespace mebots::test {

std::string with_probe(std::string text) {
  for (const auto& [word, path] :
       {std::pair<std::string, std::string>{"PROBE", PROBE_FMU}, {"COUPLING", COUPLING_FMU}}) {
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word)) text.replace(at, word.size(), path);
  }
  return text;
}

ChangedFmu::ChangedFmu(const std::string& name, const std::string& part, const std::string& text) {
  auto xml = read_file(fmt::format("{}/tests/fmus/{}.xml", MEBOTS_SOURCE_DIR, name));
  const auto at = xml.find(part);
  if (at == std::string::npos) throw Error(fmt::format("the description of {} has no {}", name, part));
  xml.replace(at, part.size(), text);
  const auto description = folder_.path() / "modelDescription.xml";
  write_file(description, xml);
  const auto library = fmt::format("binaries/linux64/{}.so", name);
  modeldesc::pack(path(), {{"modelDescription.xml", description},
                           {library, fmt::format("{}/tests/fmus/{}/{}", MEBOTS_BINARY_DIR, name, library)}});
}

void apply_set(master::SystemDescription& system, const std::string& text) {
  const auto [instance, assignment] = master::locate(system, master::read_set(text));
  instance->parameters.push_back(assignment);
}

TestRun::TestRun(const std::string& config) {
  const auto path = folder.path() / "test.json";
  write_file(path, with_probe(config));
  description = master::read_config(path);
  system = master::resolve(description, library);
  scenario.emplace(system);
  master::SlaveOptions slaves;
  slaves.overrides = &scenario->schedule();
  slaves.interrupted = &interrupted;
  simulation_.emplace(system, messages, slaves);
  auto& ensemble = simulation_->ensemble();
  scenario->watch(system, ensemble);
  simulation_->add(*scenario);
  file.emplace(folder.path() / "results.csv");
  recorder.emplace(system, ensemble);
  recorder->add(std::make_unique<master::CsvSink>(recorder->columns(), *file));
  outcomes.emplace(system, ensemble);
  stop_conditions.emplace(system, ensemble);
  simulation_->add(*recorder);
  simulation_->add(*outcomes);
  simulation_->add(*stop_conditions);
}

TestRun& TestRun::initialize() {
  simulation_->initialize();
  return *this;
}

TestRun& TestRun::to_end() {
  initialize();
  simulation_->run();
  return *this;
}

std::string TestRun::csv() {
  recorder->flush();
  return read_file(file->path());
}

std::vector<double> TestRun::column(const std::string& name) {
  std::istringstream lines(csv());
  std::string line;
  const auto next_row = [&lines, &line] {
    if (!std::getline(lines, line)) return false;
    for (std::string more; std::count(line.begin(), line.end(), '"') % 2 != 0 && std::getline(lines, more);) {
      line += '\n' + more;  // a text with line breaks
    }
    return true;
  };
  next_row();
  const auto split = [](const std::string& text) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : text) {
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        cells.emplace_back();
      } else {
        cells.back() += c;
      }
    }
    return cells;
  };
  const auto header = split(line);
  std::size_t index = 0;
  while (index < header.size() && header[index].substr(0, header[index].find(" [")) != name) ++index;
  if (index == header.size()) throw Error("no column " + name + " in " + line);
  std::vector<double> values;
  while (next_row()) {
    const auto cells = split(line);
    double value = 0;
    std::from_chars(cells.at(index).data(), cells.at(index).data() + cells.at(index).size(), value);
    values.push_back(value);
  }
  return values;
}

ProgramResult run_program(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
  const modeldesc::TemporaryFolder texts("mebots-test");
  const auto out = texts.path() / "out";
  const auto err = texts.path() / "err";
  const auto child = fork();
  if (child == 0) {
    if (chdir(folder.c_str()) != 0 || freopen(out.c_str(), "w", stdout) == nullptr ||
        freopen(err.c_str(), "w", stderr) == nullptr) {
      _exit(99);
    }
    std::vector<char*> words{const_cast<char*>(MEBOTS_PROGRAM)};
    for (const auto& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    execv(MEBOTS_PROGRAM, words.data());
    _exit(98);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_file(out), read_file(err)};
}

const std::string& sandbox_refusal() {
  static const std::string refusal = [] {
    const modeldesc::TemporaryFolder folder("mebots-test");
    write_file(folder.path() / "one.json", with_probe(R"({"step": 1, "stop_time": 1, "connections": [],
                                                          "instances": {"a": {"fmu": "PROBE", "process": "sandboxed"}}})"));
    const auto run = run_program({"run", "one.json", "--quiet"}, folder.path());
    return run.err.find("refuses a part of its sandbox") == std::string::npos ? std::string() : run.err;
  }();
  return refusal;
}

}  // namespace mebots::test
