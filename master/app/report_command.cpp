// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "report/page.hpp"
#include "sink/output_file.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

namespace mebots::app {

namespace report = master::report;

std::filesystem::path write_report(const std::vector<std::filesystem::path>& folders, std::filesystem::path file) {
  const auto parts = report::read_page_parts();
  std::vector<report::RunFolder> runs;
  runs.reserve(folders.size());
  for (const auto& folder : folders) runs.push_back(report::read_run_folder(folder));
  if (file.empty()) file = folders.front() / "flight.html";
  master::OutputFile page(file.string() + ".new");
  page.append(report::make_page(parts, runs));
  page.close();
  page.rename(file);
  return file;
}

void add_report(CLI::App& app, Action& action) {
  struct Options {
    std::vector<std::filesystem::path> folders;
    std::filesystem::path out;
  };
  const auto options = std::make_shared<Options>();
  auto* command =
      app.add_subcommand("report", "Make one page of a run's results, or of several runs beside each other");
  command->add_option("folders", options->folders, "Results folders; the first is shown in full")->required();
  command->add_option("--out", options->out, "File of the page; default: flight.html in the first folder")
      ->check(not_empty());
  command->footer(
      help_footer({"0 the page is written", "1 it is not: no space, or a mebots without pages",
                   "2 a folder is not the results folder of a run"},
                  {"mebots report results/gate_easy", "mebots report results/slow results/fast --out beside.html"}));
  command->callback([options, &action] {
    action = [options] {
      return guarded([&] {
        const auto file = write_report(options->folders, options->out);
        std::printf("page: %s\n", file.string().c_str());
      });
    };
  });
}

}  // namespace mebots::app
