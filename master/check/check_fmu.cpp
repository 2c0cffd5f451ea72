// SPDX-License-Identifier: Apache-2.0
#include "check_fmu.hpp"

#include "behaviour_check.hpp"
#include "checks.hpp"

#include "mebots/file_kind.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>

namespace mebots::check {
namespace {

namespace fs = std::filesystem;

constexpr double kUsualStep_s = 0.01;
constexpr int kMostSteps = 20;

/// Index of the probe that takes a plain run.
constexpr std::size_t kPlainRun = 1;

bool has_error(const Check& check) {
  return std::ranges::find(check.findings, Severity::error, &Finding::severity) != check.findings.end();
}

class FmuCheck {
 public:
  FmuCheck(fs::path fmu, const Options& options) : fmu_(std::move(fmu)), options_(options), folder_("mebots-check") {}

  Report run() {
    report_.fmu = fmu_.string();
    report_.level = options_.level;
    if (archive() && description() && options_.run && binaries()) behaviour();
    for (auto& check : report_.checks) {
      report_.untold +=
          std::erase_if(check.findings, [&](const Finding& finding) { return finding.level > options_.level; });
    }
    return std::move(report_);
  }

 private:
  Check& add(Group group, std::string name, Level level = Level::standard) {
    Check check;
    check.group = group;
    check.level = level;
    check.name = std::move(name);
    return report_.checks.emplace_back(std::move(check));
  }

  bool archive() {
    Check& hygiene = add(Group::archive, "the archive is a plain zip of files below one folder", Level::interoperable);
    check_archive(fmu_, hygiene);
    Check& unpacked = add(Group::archive, "all entries can be unpacked", Level::interoperable);
    try {
      modeldesc::unpack(fmu_, folder_.path());
      fs::create_directories(folder_.path() / "resources");
    } catch (const Error& error) {
      Findings(unpacked).error(error.what(), "pack the FMU again");
      return false;
    }
    return fs::is_regular_file(folder_.path() / "modelDescription.xml");
  }

  bool description() {
    const auto file = folder_.path() / "modelDescription.xml";
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    check_schema(text, add(Group::description, "modelDescription.xml has the elements and attributes of FMI 2.0"));
    Check& readable = add(Group::description, "modelDescription.xml can be read as a whole", Level::interoperable);
    try {
      model_ = modeldesc::read_xml_text(text, "modelDescription.xml");
    } catch (const Error& error) {
      Findings(readable).error(error.what(), "mend what the message names");
      return false;
    }
    report_.summary =
        fmt::format("FMI {}{}{}, {} variables", model_.fmi_version, model_.co_simulation ? " co-simulation" : "",
                    model_.has_model_exchange ? " model exchange" : "", model_.variables.size());
    const auto group = Group::description;
    check_head(model_, folder_.path(),
               add(group, "identifier, capabilities, log categories and default experiment are sound"));
    check_names(model_, add(group, "variables have unique, printable names of the declared convention"));
    check_variables(model_, add(group, "causality, variability, initial and start go together"));
    check_units_and_types(model_, add(group, "units and types are defined"));
    check_aliases(model_, add(group, "variables that share a value reference agree"));
    check_structure(model_, add(group, "ModelStructure lists all outputs and initial unknowns"));
    check_osmp(model_, add(group, "OSMP binaries are whole"));
    return true;
  }

  bool binaries() {
    Check& platforms = add(Group::binaries, "every platform has its library", Level::interoperable);
    if (!model_.co_simulation) {
      platforms.skipped = "the FMU is for model exchange only";
      return false;
    }
    const auto library = library_path(model_, folder_.path());
    const auto look = [](Check& check, auto check_it) {
      try {
        check_it(check);
      } catch (const Error& error) {
        Findings(check).error(error.what(), "build the library again");
      }
      return !has_error(check);
    };
    if (!look(platforms, [&](Check& check) { check_platforms(model_, folder_.path(), check); }) || !is_there(library))
      return false;
    look(add(Group::binaries, "the functions of FMI 2.0 are exported, and nothing else", Level::interoperable),
         [&](Check& check) { check_symbols(model_, library, check); });
    const bool found = look(add(Group::binaries, "all libraries it needs can be found", Level::interoperable),
                            [&](Check& check) { check_needed_libraries(library, check); });
    return found && can_be_run(model_, library);
  }

  void behaviour() {
    const auto& experiment = model_.default_experiment;
    const double h = experiment.step_size_s.value_or(kUsualStep_s);
    const double length =
        experiment.stop_time_s ? *experiment.stop_time_s - experiment.start_time_s.value_or(0) : HUGE_VAL;
    const int steps = static_cast<int>(std::clamp(std::floor(length / h + 1e-6), 2.0, static_cast<double>(kMostSteps)));
    Target target{&model_, folder_.path(), library_path(model_, folder_.path()), h, steps};
    target.experiment.tolerance = experiment.usable_tolerance();
    auto probes = life_probes(target, options_.half_step_tolerance);
    for (auto& probe : illegal_call_probes(target)) probes.push_back(std::move(probe));
    bool runs = true;
    for (std::size_t i = 0; i < probes.size(); ++i) {
      auto& probe = probes[i];
      if (!runs) probe.skipped = "a plain run fails";
      Check& check = add(Group::behaviour, probe.name, probe.level);
      bool good = make(probe, target, check);
      if (i == kPlainRun && !good && needs_stop_time(target)) {
        target.experiment.stop_ns = target.end_ns();
        check.findings.clear();
        good = make(probe, target, check);
      }
      if (i <= kPlainRun) runs = runs && good;
    }
  }

  /// Returns whether the FMU starts with a stop time only, which is a finding.
  bool needs_stop_time(const Target& target) {
    const auto probe = start_probe();
    Check aside;
    try {
      make(probe, target, aside);
    } catch (const Error&) {  // the plain run has found what matters
      return false;
    }
    if (!says_stop_time_is_needed(aside)) return false;
    Check& check = add(Group::behaviour, probe.name, probe.level);
    for (const auto& finding : aside.findings) Findings(check).error(finding.text, finding.way_out);
    return true;
  }

  /// Makes one experiment, unless it is to be skipped. Returns false if it found an error.
  bool make(const Probe& probe, const Target& target, Check& check) const {
    check.skipped = probe.skipped.empty() && probe.level > options_.level
                        ? fmt::format("made at --level {}", to_string(probe.level))
                        : probe.skipped;
    if (!check.skipped.empty()) return true;
    CrashRule rule;
    rule.severity = probe.crash;
    rule.deadline_s = options_.deadline_s;
    rule.given_up = options_.given_up;
    run_in_child(rule, check, [&](Witness& witness) {
      const Library library(target, witness);
      probe.run(library);
    });
    return !has_error(check);
  }

  fs::path fmu_;
  Options options_;
  modeldesc::TemporaryFolder folder_;
  modeldesc::ModelDescription model_;
  Report report_;
};

}  // namespace

Report check_fmu(const fs::path& fmu, const Options& options) {
  if (!is_there(fmu)) throw Error(ErrorCode::file_not_found, fmt::format("{}: there is no such file", fmu.string()));
  if (!is_file(fmu)) throw Error(ErrorCode::file_not_found, fmt::format("{}: this is not a file", fmu.string()));
  return FmuCheck(fmu, options).run();
}

}  // namespace mebots::check
