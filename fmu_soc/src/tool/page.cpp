// SPDX-License-Identifier: Apache-2.0
#include "tool/page.hpp"

#include "mebots/error.hpp"
#include "mebots/text_file.hpp"
#include "tool/run.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <functional>
#include <system_error>
#include <utility>
#include <vector>

namespace mebots::soc::tool {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLines = 5000;
/// State names, in the order of ChipState.
constexpr std::array<std::string_view, StateTimes::kCounted> kStates{"asleep", "waiting", "cluster", "controller"};
constexpr std::array<std::string_view, StateTimes::kCounted> kStateLabels{"asleep", "waiting for a picture",
                                                                          "cluster on", "only the controller awake"};

double seconds(Picoseconds time) {
  return static_cast<double>(time) * 1e-12;
}

std::filesystem::path page_folder() {
  std::error_code ignored;
  for (const auto& folder : own_folders("web")) {
    if (std::filesystem::exists(folder / "page.js", ignored)) return folder;
  }
  throw Error(
      "--page: this mebots-soc was built without pages: run scripts/setup.sh, which installs npm, and build with "
      "-DMEBOTS_PAGES=ON");
}

std::string spaced(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

/// Returns a column of the page: name, unit, and a value for each point.
Json column(std::string_view name, std::string_view unit, std::vector<double> values) {
  Json json = {{"name", name}, {"unit", unit}};
  const bool still = std::ranges::adjacent_find(values, std::ranges::not_equal_to()) == values.end();
  if (still && !values.empty()) {
    json["still"] = values.front();
  } else {
    json["values"] = std::move(values);
  }
  return json;
}

/// Collects the variables of the page, and the panels that draw them.
class Columns {
 public:
  Columns(const PowerCourse& course, const ChipReport& report) : points_(course.points()) {
    add("time", "s", [](const auto& point) { return seconds(point.time); });
    add_parts(report);
    add_states();
    add_devices(course.devices());
  }

  Json columns = Json::array();
  Json panels = Json::array();
  Json variables = Json::object();

 private:
  using Point = PowerCourse::Point;

  void add(const std::string& name, std::string_view unit, const std::function<double(const Point&)>& value,
           std::string_view text = "") {
    std::vector<double> values;
    values.reserve(points_.size());
    for (const auto& point : points_) values.push_back(value(point));
    columns.push_back(column(name, unit, std::move(values)));
    if (!text.empty()) variables[name] = {{"type", "Real"}, {"causality", "output"}, {"unit", unit}, {"text", text}};
  }

  /// Adds the parts of the chip to the stacked chart, starting with the greatest energy.
  void add_parts(const ChipReport& report) {
    std::vector<std::size_t> order(report.parts.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return report.parts[i].energy_j; });
    Json curves = Json::array();
    for (const auto i : order) {
      const auto& part = report.parts[i];
      if (part.energy_j == 0) continue;
      const auto name = "chip." + part.name;
      add(
          name, "J", [i](const auto& point) { return point.parts_j[i]; }, part.text);
      curves.push_back({{"rate_of", name}, {"label", spaced(part.name)}});
    }
    add_panel("Power of the chip", "stack", std::move(curves));
  }

  void add_states() {
    Json curves = Json::array();
    for (std::size_t i = kStates.size(); i-- > 0;) {
      if (points_.back().in_state[i] == 0) continue;
      const auto name = fmt::format("state_time.{}", kStates[i]);
      add(
          name, "s", [i](const auto& point) { return seconds(point.in_state[i]); },
          fmt::format("Time since the start: {}", kStateLabels[i]));
      curves.push_back({{"rate_of", name}, {"label", kStateLabels[i]}});
    }
    add_panel("Time in each state", "stack", std::move(curves));
  }

  void add_devices(const std::vector<std::string>& devices) {
    Json curves = Json::array();
    for (std::size_t i = 0; i < devices.size(); ++i) {
      if (points_.back().devices_j[i] == 0) continue;
      const auto name = "board." + devices[i];
      add(
          name, "J", [i](const auto& point) { return point.devices_j[i]; }, "Energy of a device of the board");
      curves.push_back({{"rate_of", name}, {"label", spaced(devices[i])}});
    }
    add_panel("Power of the board's devices", "lines", std::move(curves));
  }

  void add_panel(std::string_view title, std::string_view kind, Json curves) {
    if (!curves.empty()) panels.push_back({{"title", title}, {"kind", kind}, {"curves", std::move(curves)}});
  }

  const std::vector<Point>& points_;
};

Json summary_of(const ChipReport& report, const std::string& outcome) {
  Json energy = {{"delivered", report.chip_j}};
  Json units = {{"delivered", "J"}};
  for (const auto& part : report.parts) {
    energy[part.name] = part.energy_j;
    units[part.name] = "J";
  }
  return {{"outcome", outcome}, {"end_text", outcome},          {"simulated_time", report.time_s},
          {"energy", energy},   {"units", {{"energy", units}}}, {"versions", {{"mebots", MEBOTS_VERSION}}}};
}

/// Returns the clock of a core over the run, or null if the core never had power.
Json clock_json(const ClockRange& clock) {
  if (!clock.has_run()) return nullptr;
  return {{"least_hz", clock.least_hz()}, {"most_hz", clock.most_hz()}, {"mean_hz", clock.mean_hz()}};
}

/// Returns the data of the page's tables: the report, clocks, and a description of each part.
Json tables_of(const ChipReport& report, const PowerCourse& course) {
  auto chip = Json::parse(json_text(report));
  for (const auto* list : {&report.parts, &report.devices}) {
    for (const auto& part : *list) chip["texts"][part.name] = part.text;
  }
  chip["clocks"] = {{"controller", clock_json(course.controller_clock())},
                    {"cluster", clock_json(course.cluster_clock())}};
  for (std::size_t i = 0; i < kStates.size(); ++i) {
    chip["states_s"][std::string(kStateLabels[i])] = seconds(course.points().back().in_state[i]);
  }
  return chip;
}

/// Returns the data that the HTML page contains: length of the header (32 bits, little-endian), header, columns.
/// web/src/data/payload.ts reads this format.
std::string payload_of(const Json& run) {
  const Json header = {{"format", 1}, {"runs", Json::array({run})}};
  const auto text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string bytes;
  for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(text.size() >> shift & 0xff);
  return bytes + text;
}

}  // namespace

ScratchFile::ScratchFile(std::string_view ending) {
  std::error_code ignored;
  const auto folder = std::filesystem::temp_directory_path(ignored);
  path_ = fmt::format("{}/mebots-soc-XXXXXX{}", folder.string(), ending);
  const int file = mkstemps(path_.data(), static_cast<int>(ending.size()));
  if (file == -1)
    throw Error(fmt::format("{}: this file cannot be created: {}", path_, std::generic_category().message(errno)));
  close(file);
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

RunPage::RunPage(const std::string& path, const std::optional<std::string>& profile)
    : parts_(read_page_parts(page_folder(), "page")), file_("--page", path), profile_(profile) {
  if (!profile_) scratch_.emplace(".json");
}

void RunPage::follow(const Soc& soc, observe::Session& session) {
  soc_ = &soc;
  session.listen(course_.emplace(soc));
}

void RunPage::printed(std::string_view line) {
  if (++lines_ > kMostLines || soc_ == nullptr) return;
  log_ += fmt::format("[{:9.6f} s] program: {}\n", seconds(soc_->core_time()), line);
}

void RunPage::sent(char byte) {
  if (byte != '\n') {
    if (byte != '\r') sent_ += byte;
    return;
  }
  printed(sent_);
  sent_.clear();
}

void RunPage::write(const ChipReport& report, const std::string& program, const std::string& outcome) {
  course_->finish();
  if (!sent_.empty()) printed(sent_);
  Columns columns(*course_, report);
  if (lines_ > kMostLines) log_ += fmt::format("notice: the program printed {} more lines\n", lines_ - kMostLines);
  const auto name = std::filesystem::path(program).filename().string();
  const auto rows = course_->points().size();
  const Json system = {
      {"name", name},
      {"text", fmt::format("{} on the chip of board {}, without a mission.", name, soc_->board().name)},
      {"step", 0},
      {"stop_time", 0},
      {"instances", Json::object()},
      {"connections", Json::array()},
      {"variables", columns.variables},
      {"view", {{"panels", columns.panels}, {"marks", Json::array()}}}};
  const Json run = {{"name", name},
                    {"system", system},
                    {"summary", summary_of(report, outcome)},
                    {"chip", tables_of(report, *course_)},
                    {"log", log_},
                    {"texts", Json::array()},
                    {"rows", rows},
                    {"span", 1},
                    {"whole", Json::array()},
                    {"kept", rows},
                    {"columns", columns.columns},
                    {"scene", nullptr},
                    {"profiles", Json::array({Json::parse(text_of(profile()))})},
                    {"live", nullptr},
                    {"pictures", Json::array()}};
  file_.put(fill_page(parts_, name, payload_of(run)));
  file_.close();
}

}  // namespace mebots::soc::tool
