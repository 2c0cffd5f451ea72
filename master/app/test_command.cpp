// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "cases/run_case.hpp"
#include "junit_report.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"
#include "model/resolved_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace mebots::app {
namespace {

namespace cases = master::cases;

struct TestOptions {
  std::vector<std::filesystem::path> files;  // an optional FMU, then the file of cases
  std::filesystem::path junit;
  std::filesystem::path out;
  std::string pattern = "*";
  bool isolate = false;
};

JunitCase junit_case(const cases::CaseResult& result) {
  const auto outcome = result.verdict == cases::Verdict::passed   ? JunitOutcome::passed
                       : result.verdict == cases::Verdict::failed ? JunitOutcome::failure
                                                                  : JunitOutcome::error;
  return {result.name, outcome, outcome == JunitOutcome::passed ? "" : result.text(), result.wall_s, ""};
}

int run_cases(const TestOptions& options) {
  const auto file = cases::read_cases(options.files.back());
  const auto fmu = options.files.size() == 2 ? options.files.front() : cases::fmu_of(file);
  if (!is_file(fmu))
    throw InputError(ErrorCode::file_not_found, fmt::format("{}: there is no such file", fmu.string()));
  if (!options.junit.empty()) require_folder_of(options.junit);
  std::vector<JunitCase> reports;
  std::size_t bad = 0;
  for (const auto& description : file.cases) {
    if (!master::fits(description.name, options.pattern)) continue;
    cases::CaseOptions how{.isolate = options.isolate};
    if (!options.out.empty()) how.folder = options.out / description.name;
    const auto result = cases::run_case(fmu, description, how);
    bad += result.verdict == cases::Verdict::passed ? 0 : 1;
    print_product(fmt::format("{} {}: {}\n", cases::name_of(result.verdict), result.name, result.text()));
    reports.push_back(junit_case(result));
  }
  if (reports.empty()) {
    throw InputError(ErrorCode::unknown_name, fmt::format("{}: no case has a name that matches '{}'",
                                                          options.files.back().string(), options.pattern));
  }
  print_product(fmt::format("{} of {} cases passed\n", reports.size() - bad, reports.size()));
  if (!options.junit.empty()) write_junit(options.junit, fmu.stem().string(), reports);
  return bad == 0 ? 0 : 1;
}

int test_command(const TestOptions& options) {
  int code = 0;
  const int failure = guarded([&] { code = run_cases(options); });
  return failure != 0 ? failure : code;
}

}  // namespace

void add_test(CLI::App& app, Action& action) {
  const auto options = std::make_shared<TestOptions>();
  auto* command = app.add_subcommand("test", "Run an FMU alone with inputs from CSV files; compare its outputs");
  command->add_option("files", options->files, "FMU, unless the cases name it, and file of cases (.json)")
      ->type_name("[FILE.fmu] CASES.json")
      ->required()
      ->expected(1, 2);
  command->add_option("--case", options->pattern, "Run the cases with these names (* and ? allowed)")
      ->type_name("PATTERN");
  command->add_option("--junit", options->junit, "Write a JUnit report, one test case per case")->type_name("FILE.xml");
  command->add_option("--out", options->out, "Keep the results of each case in a folder of its name")
      ->type_name("FOLDER");
  command->add_flag("--isolate", options->isolate, "Run the FMU in a separate process");
  command->footer(help_footer({"0 all cases passed", "1 a case failed", "2 the cases or the FMU cannot be read"},
                              {"mebots test heater.fmu heater/test/cases.mebots-test.json",
                               "mebots test heater/test/cases.mebots-test.json --junit report.xml"}));
  command->callback([options, &action] { action = [options] { return test_command(*options); }; });
}

}  // namespace mebots::app
