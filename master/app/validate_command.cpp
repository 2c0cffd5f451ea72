// SPDX-License-Identifier: Apache-2.0
// Implements `mebots validate`, which only reads and checks files.
#include "command.hpp"

#include "cases/case_file.hpp"
#include "description.hpp"
#include "io/config/load_system.hpp"
#include "io/flight/airframe_file.hpp"
#include "io/study/study_file.hpp"
#include "mebots/data/document.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"

#ifdef MEBOTS_HAS_battery
#include "cell.hpp"
#include "converter.hpp"
#endif
#ifdef MEBOTS_HAS_motors
#include "rotor_data.hpp"
#endif
#ifdef MEBOTS_HAS_soc
#include "board/board_file.hpp"
#endif
#ifdef MEBOTS_HAS_world
#include "scene/downwash_networks.hpp"
#include "scene/load.hpp"
#endif

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <unordered_set>
#include <vector>

namespace mebots::app {
namespace {

using Path = std::filesystem::path;

struct FileKind {
  std::string_view name;
  /// Reads a file of this kind. Throws Error, usually data::Mistakes, if the file is invalid.
  void (*read)(const Path& file);
};

/// The kinds of files that `mebots validate` supports in this build.
constexpr FileKind kKinds[] = {
    {"config", &master::config::check},
    {"scenario", &master::config::check_scenario},
    {"cases", [](const Path& file) { static_cast<void>(master::cases::read_cases(file)); }},
    {"airframe", [](const Path& file) { static_cast<void>(master::flight::read_airframe(file)); }},
    {"log-mapping", [](const Path& file) { static_cast<void>(master::flight::read_log_mapping(file)); }},
    {"study", [](const Path& file) { static_cast<void>(master::study::read(file)); }},
    {"description", [](const Path& file) { static_cast<void>(modeldesc::read_description(file)); }},
#ifdef MEBOTS_HAS_battery
    {"cell", [](const Path& file) { static_cast<void>(battery::load_cell(file)); }},
    {"converters", [](const Path& file) { static_cast<void>(battery::load_converters(file)); }},
#endif
#ifdef MEBOTS_HAS_motors
    {"rotor", [](const Path& file) { static_cast<void>(motors::load_rotor(file)); }},
#endif
#ifdef MEBOTS_HAS_soc
    {"board",
     [](const Path& file) {
       // A board has two checks: read_board() for all parts except the variables, and check_board_variables() for
       // these.
       data::Document(file).read([&](const data::Node& root) {
         root.attempt([&] { static_cast<void>(soc::read_board(file)); });
         root.attempt([&] { modeldesc::check_board_variables(file); });
       });
     }},
#endif
#ifdef MEBOTS_HAS_world
    {"downwash", [](const Path& file) { static_cast<void>(world::scene::load_downwash_networks(file)); }},
    {"drone", [](const Path& file) { static_cast<void>(world::scene::load_drone(file)); }},
    {"scene", [](const Path& file) { static_cast<void>(world::scene::load_scene(file)); }},
#endif
};

std::vector<std::string> known_kinds() {
  std::vector<std::string> names;
  for (const auto& schema : master::schemas()) names.emplace_back(schema.kind);
  return names;
}

/// Returns the kind in a "$schema" value, such as "cell" for ".../mebots-cell.schema.json".
std::string named_kind(const data::Node& schema) {
  const auto name = Path(schema.text()).filename().string();
  for (const auto& kind : known_kinds()) {
    if (name == "mebots-" + kind + ".schema.json") return kind;
  }
  schema.fail_unknown("the kind of file", name, known_kinds());
}

struct Likeness {
  std::size_t common = 0;  // number of the file's top-level keys that the schema defines
  std::size_t others = 0;  // number of the schema's top-level keys that the file lacks
};

Likeness likeness(const master::Schema& schema, const data::Node& root) {
  return data::Document(schema.text, std::string(schema.kind)).read([&](const data::Node& described) {
    const auto properties = described.at("properties");
    Likeness found;
    for (const auto& [key, value] : properties.members()) {
      if (key == "$schema") continue;
      ++(root.has(key) ? found.common : found.others);
    }
    return found;
  });
}

/// Returns the kind whose schema defines most of the file's keys. Among equals, returns the schema with the fewest
/// missing keys. Recognises a file of converters by its members, because its keys are names.
std::string kind_by_content(const data::Node& root) {
  std::string best;
  Likeness most;
  for (const auto& schema : master::schemas()) {
    const auto found = likeness(schema, root);
    if (found.common < most.common || found.common == 0) continue;
    if (found.common == most.common && found.others >= most.others) continue;
    most = found;
    best = schema.kind;
  }
  const auto members = root.members();
  const bool converters =
      std::ranges::any_of(members, [](const auto& member) { return member.value.has("efficiency"); });
  if (converters && most.common == 0) return "converters";
  if (best.empty()) {
    root.fail(ErrorCode::invalid_value,
              "the kind of file is unknown; name its schema under \"$schema\". " + suggest("", known_kinds()));
  }
  return best;
}

std::string kind_of(const Path& file) {
  if (file.extension() == ".fmu") {
    throw InputError(
        ErrorCode::wrong_type,
        fmt::format("{}: this is an FMU: `mebots check` tests it, and `mebots info` shows it", file.string()));
  }
  std::string kind;
  // Ignores errors such as duplicate keys, which the reader of this kind reports later.
  data::Document document(file);
  try {
    document.read([&](const data::Node& root) {
      const auto schema = root.find("$schema");
      kind = schema && schema->is(data::Kind::text) ? named_kind(*schema) : kind_by_content(root);
    });
  } catch (const data::Mistakes&) {
    if (kind.empty()) throw;
  }
  return kind;
}

void print_mistake(const std::string& place, const std::string& text, ErrorCode code) {
  std::fprintf(stderr, "%s%s%s [%s]\n", place.c_str(), place.empty() ? "" : ": ", text.c_str(),
               std::string(name_of(code)).c_str());
}

/// Prints all errors of a file. Returns true if the file has none.
bool validate(const Path& file) {
  try {
    const auto kind = kind_of(file);
    const auto* const found = std::ranges::find(kKinds, kind, &FileKind::name);
    if (found == std::end(kKinds)) {
      print_mistake(file.string(), "this build has no reader of the kind of file '" + kind + "'",
                    ErrorCode::not_offered);
      return false;
    }
    found->read(file);
    std::printf("%s: valid %s file\n", file.c_str(), kind.c_str());
    return true;
  } catch (const data::Mistakes& mistakes) {
    std::unordered_set<std::string> printed;  // both readers of a board may report the same error
    for (const auto& mistake : mistakes.list()) {
      if (printed.insert(mistake.place + mistake.text).second) print_mistake(mistake.place, mistake.text, mistake.code);
    }
  } catch (const Error& error) {
    print_mistake("", error.what(), error.code());
  }
  return false;
}

int validate_all(const std::vector<std::string>& files) {
  bool good = true;
  for (const auto& file : files) good &= validate(file);
  return good ? 0 : 2;
}

}  // namespace

void add_validate(CLI::App& app, Action& action) {
  auto* command =
      app.add_subcommand("validate", "List all errors in configs, boards, scenes and other files; run nothing");
  const auto files = std::make_shared<std::vector<std::string>>();
  std::string kinds;
  for (const auto& kind : known_kinds()) kinds += (kinds.empty() ? "" : ", ") + kind;
  command->add_option("files", *files, "Files (.json); \"$schema\" or their keys determine the kind: " + kinds)
      ->type_name("FILE.json")
      ->required();
  command->footer(
      help_footer({"0 all files are valid", "2 a file has errors, or cannot be read"},
                  {"mebots validate mission.json", "mebots validate configs/*.json configs/boards/*.json"}));
  command->callback([&action, files] { action = [files] { return validate_all(*files); }; });
}

}  // namespace mebots::app
