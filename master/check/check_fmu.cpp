// SPDX-License-Identifier: Apache-2.0
#include "check_fmu.hpp"

#include "behaviour_check.hpp"
#include "checks.hpp"
#include "exchange_probes.hpp"
#include "fmi1_check.hpp"
#include "fmi3_probes.hpp"
#include "plain_run.hpp"

#include "fmi/fmu.hpp"
#include "fmi/windows/wine.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <pugixml.hpp>

namespace mebots::check {
namespace {

namespace fs = std::filesystem;

/// Index of the plain run among the probes.
constexpr std::size_t kPlainRun = 1;

std::string plain_run_name(const char* end) {
  return fmt::format("a plain run of {} steps {}, with finite scalar outputs", kPlainSteps, end);
}

bool has_error(const Check& check) {
  return std::ranges::find(check.findings, Severity::error, &Finding::severity) != check.findings.end();
}

class FmuCheck {
 public:
  FmuCheck(fs::path fmu, const Options& options) : fmu_(std::move(fmu)), options_(options), folder_("mebots-check") {}

  Report run() {
    report_.fmu = fmu_.string();
    report_.level = options_.level;
    if (archive()) {
      report_.platforms = list_platforms(folder_.path());
      const auto version = text_version();
      if (version == "1.0")
        run_fmi1();
      else if (version.starts_with("3."))
        run_fmi3();
      else if (description() && options_.run)
        run_fmi2();
    }
    for (auto& check : report_.checks) {
      report_.hidden_findings +=
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

  std::string description_text() const {
    std::ifstream stream(folder_.path() / "modelDescription.xml", std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  /// Returns the FMI version in the file, which determines the rules. Empty if the file is not XML; then the rules of
  /// FMI 2.0 apply.
  std::string text_version() const {
    pugi::xml_document document;
    document.load_file((folder_.path() / "modelDescription.xml").c_str());
    return document.document_element().attribute("fmiVersion").value();
  }

  void run_fmi1() {
    if (!fmi1_description()) return;
    const auto& flags = model_.co_simulation;
    Check& platforms = add(Group::binaries, "every platform has its library", Level::interoperable);
    if (!flags) {
      platforms.skipped = "the FMU is for model exchange only";
      return;
    }
    check_platforms(model_, flags->model_identifier, folder_.path(), platforms);
    const auto library = library_path(flags->model_identifier, folder_.path());
    if (!options_.run) return;
    if (!is_own_binary(library)) {
      run_under_wine();
      return;
    }
    Check& symbols = add(Group::binaries, "the functions of FMI 1.0 are exported", Level::interoperable);
    check_fmi1_symbols(model_, library, symbols);
    Check& needed = add(Group::binaries, "all libraries it needs can be found", Level::interoperable);
    check_needed_libraries(library, needed);
    if (has_error(symbols) || has_error(needed)) return;
    const auto run = [&](int instances) {
      return [&, instances](Witness& witness) { run_plainly(fmu_, folder_.path(), instances, kPlainStep_s, witness); };
    };
    Check& one = add(Group::behaviour, plain_run_name("succeeds"));
    run_in_child(crash_rule(), one, run(1));
    Check& two = add(Group::behaviour, "two instances run in one process");
    if (flags->can_be_instantiated_only_once_per_process) two.skipped = "the FMU allows one instance per process";
    if (has_error(one)) two.skipped = "a plain run fails";
    if (two.skipped.empty()) run_in_child(crash_rule(), two, run(2));
  }

  bool fmi1_description() {
    const auto text = description_text();
    Check& schema = add(Group::description, "modelDescription.xml has the elements and attributes of FMI 1.0");
    check_schema(text, schema);
    try {
      model_ = modeldesc::read_xml_text(text, "modelDescription.xml");
    } catch (const Error& error) {
      if (!has_error(schema)) Findings(schema).error(error.what(), "correct what the message names");
      return false;
    }
    report_.summary = fmt::format("FMI 1.0 {}, {} variables", model_.co_simulation ? "co-simulation" : "model exchange",
                                  model_.variables.size());
    check_fmi1_variables(model_, add(Group::description, "variables have unique names and start values"));
    return true;
  }

  void run_fmi3() {
    const auto text = description_text();
    Check& schema = add(Group::description, "modelDescription.xml has the elements and attributes of FMI 3.0");
    check_schema(text, schema);
    std::optional<Fmi3Description> description;
    try {
      description.emplace(text);
    } catch (const Error& error) {
      if (!has_error(schema)) Findings(schema).error(error.what(), "correct what the message names");
      return;
    }
    std::string kinds;
    for (const auto node : description->interfaces()) kinds += fmt::format(" {}", node.name());
    report_.summary = fmt::format("FMI 3.0{}, {} variables", kinds, description->variables().size());
    check_fmi3_text(*description);
    if (!options_.run || has_error(schema)) return;
    const Fmi3Target target{&*description, folder_.path(), fmi3_library_path(*description, folder_.path())};
    if (!fmi3_binaries(target)) return;
    run_probes(fmi3_probes(target));
    if (description->root().child("ModelExchange")) fmi3_exchange();
  }

  void check_fmi3_text(const Fmi3Description& description) {
    const auto group = Group::description;
    check_fmi3_head(description,
                    add(group, "identifier, capabilities, log categories and default experiment are valid"));
    check_fmi3_names(description, add(group, "variables have unique names and value references"));
    check_fmi3_kinds(description, add(group, "causality, variability, initial and start are compatible"));
    check_fmi3_types(description, add(group, "units and types are defined, and start values are within limits"));
    check_fmi3_arrays(description, add(group, "dimensions and structural parameters are valid"));
    check_fmi3_clocks(description, add(group, "clocks have their intervals"));
    check_fmi3_structure(description, add(group, "ModelStructure lists all outputs and initial unknowns"));
    check_fmi3_terminals(description, folder_.path(), add(group, "terminals and icons are valid"));
    check_extra(folder_.path(), add(group, "layered standards have their manifests"));
  }

  bool fmi3_binaries(const Fmi3Target& target) {
    Check& platforms = add(Group::binaries, "every platform has its library", Level::interoperable);
    check_fmi3_platforms(*target.description, target.folder, platforms);
    if (!is_own_binary(target.library)) {
      run_under_wine();
      return false;
    }
    Check& symbols =
        add(Group::binaries, "the functions of FMI 3.0 are exported, and nothing else", Level::interoperable);
    check_fmi3_symbols(*target.description, target.library, symbols);
    Check& needed = add(Group::binaries, "all libraries it needs can be found", Level::interoperable);
    check_needed_libraries(target.library, needed);
    return !has_error(symbols) && !has_error(needed);
  }

  void fmi3_exchange() {
    try {
      model_ = modeldesc::read_xml(folder_.path() / "modelDescription.xml");
    } catch (const Error& error) {
      Findings(add(Group::behaviour, "the master reads the description"))
          .error(error.what(), "correct what the message names");
      return;
    }
    run_probes(exchange_probes(fmu_, folder_.path(), model_));
  }

  void run_probes(const std::vector<ChildProbe>& probes) {
    bool runs = true;
    for (const auto& probe : probes) {
      Check& check = add(Group::behaviour, probe.name);
      check.skipped = !probe.skipped.empty() ? probe.skipped : runs || probe.is_plain ? "" : "a plain run fails";
      if (!check.skipped.empty()) continue;
      run_in_child(crash_rule(), check, probe.run);
      if (probe.is_plain) runs = !has_error(check);
    }
  }

  /// Runs an FMU under wine if it has a library for 64-bit Windows and none for this machine. Skips other probes,
  /// because they call the library directly.
  void run_under_wine() {
    const modeldesc::TemporaryFolder place("mebots-check-wine");
    const auto folder = place.path() / "fmu";
    fs::create_directories(folder);
    modeldesc::unpack(fmu_, folder);
    double step_s = kPlainStep_s;
    try {
      const master::Fmu fmu(fmu_, folder, master::FmuKind::co_simulation);
      if (!fmu.is_for_windows_alone()) return;
      step_s = fmu.description().default_experiment.step_size_s.value_or(kPlainStep_s);
    } catch (const Error&) {  // a model exchange FMU, or an error that the description checks report
      return;
    }
    Check& plain = add(Group::behaviour, plain_run_name("under wine succeeds"));
    plain.skipped = master::windows::find_wine().missing;
    if (plain.skipped.empty())
      run_in_child(crash_rule(), plain, [&](Witness& witness) { run_plainly(fmu_, folder, 1, step_s, witness); });
    add(Group::behaviour, "calls in every state, saved states and faults are as FMI demands").skipped =
        "under wine only a plain run is made";
  }

  CrashRule crash_rule() const {
    CrashRule rule;
    rule.deadline_s = options_.deadline_s;
    rule.given_up = options_.given_up;
    return rule;
  }

  bool description() {
    const auto text = description_text();
    check_schema(text, add(Group::description, "modelDescription.xml has the elements and attributes of FMI 2.0"));
    Check& readable = add(Group::description, "modelDescription.xml can be read as a whole", Level::interoperable);
    try {
      model_ = modeldesc::read_xml_text(text, "modelDescription.xml");
    } catch (const Error& error) {
      Findings(readable).error(error.what(), "correct what the message names");
      return false;
    }
    report_.summary =
        fmt::format("FMI {}{}{}, {} variables", model_.fmi_version, model_.co_simulation ? " co-simulation" : "",
                    model_.model_exchange ? " model exchange" : "", model_.variables.size());
    const auto group = Group::description;
    check_head(model_, folder_.path(),
               add(group, "identifier, capabilities, log categories and default experiment are valid"));
    check_names(model_, add(group, "variables have unique, printable names of the declared convention"));
    check_variables(model_, add(group, "causality, variability, initial and start are compatible"));
    check_units_and_types(model_, add(group, "units and types are defined"));
    check_aliases(model_, add(group, "variables that share a value reference agree"));
    check_structure(model_, add(group, "ModelStructure lists all outputs and initial unknowns"));
    check_osmp(model_, add(group, "OSMP binaries are complete"));
    return true;
  }

  void run_fmi2() {
    using enum master::FmuKind;
    const auto& exchange = model_.model_exchange;
    if (model_.co_simulation) {
      const auto& identifier = model_.co_simulation->model_identifier;
      if (library_binaries(identifier) && exports_all(co_simulation, identifier)) behaviour();
    }
    if (!exchange) return;
    const bool same = model_.co_simulation && model_.co_simulation->model_identifier == exchange->model_identifier;
    const bool usable = same ? is_own_binary(library_path(exchange->model_identifier, folder_.path()))
                             : library_binaries(exchange->model_identifier);
    if (usable && exports_all(model_exchange, exchange->model_identifier))
      run_probes(exchange_probes(fmu_, folder_.path(), model_));
  }

  /// Calls `make`, which checks a library. If the library cannot be read, reports an error and returns false.
  template <typename Make>
  static bool look(Check& check, const Make& make) {
    try {
      make(check);
    } catch (const Error& error) {
      Findings(check).error(error.what(), "build the library again");
    }
    return !has_error(check);
  }

  /// Checks the libraries with this name. Returns true if the library for this machine can be loaded.
  bool library_binaries(const std::string& identifier) {
    Check& platforms = add(Group::binaries, "every platform has its library", Level::interoperable);
    const auto library = library_path(identifier, folder_.path());
    look(platforms, [&](Check& check) { check_platforms(model_, identifier, folder_.path(), check); });
    if (!is_own_binary(library)) {
      if (model_.co_simulation && model_.co_simulation->model_identifier == identifier) run_under_wine();
      return false;
    }
    look(add(Group::binaries, "nothing but functions of FMI 2.0 is exported", Level::interoperable),
         [&](Check& check) { check_other_symbols(library, check); });
    return look(add(Group::binaries, "all libraries it needs can be found", Level::interoperable),
                [&](Check& check) { check_needed_libraries(library, check); });
  }

  bool exports_all(master::FmuKind kind, const std::string& identifier) {
    const auto library = library_path(identifier, folder_.path());
    bool runs = false;
    look(add(Group::binaries, fmt::format("the functions of <{}> are exported", master::element_of(kind)),
             Level::interoperable),
         [&](Check& check) {
           check_symbols(model_, kind, library, check);
           runs = can_be_run(model_, kind, library);
         });
    return runs;
  }

  void behaviour() {
    const auto& experiment = model_.default_experiment;
    const double h = experiment.step_size_s.value_or(kPlainStep_s);
    const double length =
        experiment.stop_time_s ? *experiment.stop_time_s - experiment.start_time_s.value_or(0) : HUGE_VAL;
    const int steps =
        static_cast<int>(std::clamp(std::floor(length / h + 1e-6), 2.0, static_cast<double>(kPlainSteps)));
    Target target{&model_, folder_.path(), library_path(model_.co_simulation->model_identifier, folder_.path()), h,
                  steps};
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

  /// If the FMU only starts with a stop time, reports this and returns true.
  bool needs_stop_time(const Target& target) {
    const auto probe = start_probe();
    Check aside;
    try {
      make(probe, target, aside);
    } catch (const Error&) {  // the plain run reports such errors
      return false;
    }
    if (!says_stop_time_is_needed(aside)) return false;
    Check& check = add(Group::behaviour, probe.name, probe.level);
    for (const auto& finding : aside.findings) Findings(check).error(finding.text, finding.way_out);
    return true;
  }

  /// Runs an experiment unless it must be skipped. Returns false if the experiment found an error.
  bool make(const Probe& probe, const Target& target, Check& check) const {
    check.skipped = probe.skipped.empty() && probe.level > options_.level
                        ? fmt::format("made at --level {}", to_string(probe.level))
                        : probe.skipped;
    if (!check.skipped.empty()) return true;
    CrashRule rule = crash_rule();
    rule.severity = probe.crash;
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
