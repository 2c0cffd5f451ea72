// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "io/config/schemas.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

void print_schema(const std::string& kind) {
  const auto all = master::schemas();
  const auto found = std::ranges::find(all, kind, &master::Schema::kind);
  if (found == all.end()) {
    std::vector<std::string> known;
    for (const auto& schema : all) known.emplace_back(schema.kind);
    throw InputError(ErrorCode::unknown_name, "there is no kind of file '" + kind + "'. " + suggest(kind, known));
  }
  print_product(found->text);
}

}  // namespace

void add_schema(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand("schema", "Print the JSON schema of a kind of file");
  const auto kind = std::make_shared<std::string>("config");
  std::string kinds;
  for (const auto& schema : master::schemas()) kinds += (kinds.empty() ? "" : ", ") + std::string(schema.kind);
  command->add_option("kind", *kind, "Kind of file: " + kinds)->type_name("KIND")->capture_default_str();
  command->footer(help_footer({"0 printed", "1 standard output is closed or full", "2 there is no such kind of file"},
                              {"mebots schema > mebots-config.schema.json", "mebots schema board"}));
  command->callback([&action, kind] { action = [kind] { return guarded([&] { print_schema(*kind); }); }; });
}

}  // namespace mebots::app
