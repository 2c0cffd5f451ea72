// SPDX-License-Identifier: Apache-2.0
#include "missions.hpp"

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <utility>

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

std::map<std::string, std::vector<std::string>> columns(const std::string& results) {
  std::istringstream lines(results);
  std::string line;
  std::getline(lines, line);
  std::vector<std::string> names;
  std::istringstream header(line);
  for (std::string cell; std::getline(header, cell, ',');) names.push_back(cell.substr(0, cell.rfind(" [")));
  std::vector<std::vector<std::string>> cells(names.size());
  while (std::getline(lines, line)) {
    std::istringstream row(line);
    std::string cell;
    for (auto& column : cells) {
      std::getline(row, cell, ',');
      column.push_back(cell);
    }
  }
  std::map<std::string, std::vector<std::string>> table;
  for (std::size_t i = 0; i < names.size(); ++i) table.emplace(names[i], std::move(cells[i]));
  return table;
}

std::vector<double> column(const std::string& results, const std::string& name) {
  const auto table = columns(results);
  const auto found = table.find(name);
  if (found == table.end()) throw std::runtime_error("no column " + name);
  std::vector<double> values;
  for (const auto& cell : found->second) values.push_back(std::stod(cell));
  return values;
}

}  // namespace mebots::system_test
