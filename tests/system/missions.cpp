// SPDX-License-Identifier: Apache-2.0
#include "missions.hpp"

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <stdexcept>

namespace mebots::system_test {

nlohmann::ordered_json shipped_config(const std::string& name) {
  return nlohmann::ordered_json::parse(
      read_file(std::filesystem::path(MEBOTS_SOURCE_DIR) / "configs" / (name + ".json")));
}

std::filesystem::path write(const std::filesystem::path& path, const nlohmann::ordered_json& config) {
  mebots::test::write_file(path, config.dump(2));
  return path;
}

Flight fly(const std::filesystem::path& config, const std::filesystem::path& out, const std::vector<std::string>& sets,
           const std::vector<std::string>& more) {
  const auto quoted = [](const std::string& text) { return " '" + text + "'"; };
  std::string command = quoted(MEBOTS_PROGRAM) + " run" + quoted(config.string()) + " --out" + quoted(out.string());
  for (const auto& set : sets) command += " --set" + quoted(set);
  for (const auto& option : more) command += quoted(option);
  command += " 2>&1";

  Flight flight;
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot run " + command);
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    flight.output.append(buffer.data(), n);
  }
  const int status = ::pclose(pipe);
  flight.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  flight.results = read_file(out / "results.csv");
  const auto summary = read_file(out / "summary.json");
  if (!summary.empty()) flight.summary = nlohmann::json::parse(summary);
  return flight;
}

std::vector<std::string> column_names(const std::string& results) {
  std::istringstream header(results.substr(0, results.find('\n')));
  std::vector<std::string> names;
  for (std::string cell; std::getline(header, cell, ',');) names.push_back(cell.substr(0, cell.rfind(" [")));
  names.erase(names.begin());
  return names;
}

std::vector<double> column(const std::string& results, const std::string& name) {
  std::istringstream lines(results);
  std::string line;
  std::getline(lines, line);
  std::size_t index = 0;
  bool found = false;
  std::istringstream header(line);
  for (std::string cell; std::getline(header, cell, ',');) {
    if (cell.substr(0, cell.rfind(" [")) == name) {
      found = true;
      break;
    }
    ++index;
  }
  if (!found) throw std::runtime_error("no column " + name);
  std::vector<double> values;
  while (std::getline(lines, line)) {
    std::istringstream row(line);
    std::string cell;
    for (std::size_t i = 0; i <= index; ++i) std::getline(row, cell, ',');
    values.push_back(std::stod(cell));
  }
  return values;
}

}  // namespace mebots::system_test
