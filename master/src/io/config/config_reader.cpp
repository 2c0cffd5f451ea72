// SPDX-License-Identifier: Apache-2.0
// Reads configs. Each section of a config has a reader in config/. A new section needs a row in kSections, a reader in
// a new file, and a property in configs/schemas/mebots-config.schema.json. A config can also be a variant of another
// config (variant.cpp).
#include "io/config/load_system.hpp"
#include "io/fmu_archive.hpp"
#include "io/osp/osp.hpp"
#include "io/ssp/ssp.hpp"
#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/json_document.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "message/message_text.hpp"

#include "base/input_text.hpp"
#include "io/config/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

namespace mebots::master {
namespace {

struct Section {
  std::string_view key;
  bool required;
  void (*read)(const data::Node&, SystemDescription&);
  bool names_instances = false;
};

// Sections in the order in which they are read. A reader may use the sections before its own. The order in the file has
// no effect.
constexpr Section kSections[] = {
    {"$schema", false, &config::read_text},
    {"text", false, &config::read_text},
    {"step", true, &config::read_step},
    {config::kGroups, false, &config::read_groups},
    {"instances", true, &config::read_instances},
    {"start_time", false, &config::read_start_time},
    {"stop_time", true, &config::read_stop_time},
    {"connections", false, &config::read_connections, true},
    {"algorithm", false, &config::read_algorithm, true},
    {"step_control", false, &config::read_step_control},
    {"solver", false, &config::read_solver},
    {"inputs", false, &config::read_inputs, true},
    {"scenario", false, &config::read_scenario, true},
    {"stop_when", false, &config::read_stop_when, true},
    {"outcomes", false, &config::read_outcomes, true},
    {"summary", false, &config::read_summary, true},
    {"record", false, &config::read_record},
    {"pictures", false, &config::read_pictures, true},
    {"view", false, &config::read_view, true},
    {"coupling", false, &config::read_coupling, true},
    {"log", false, &config::read_log, true},
    {"uncertainty", false, &config::read_uncertainty},
    {"threads", false, &config::read_threads},
};

void refuse_archive(std::string_view text, const std::filesystem::path& file) {
  if (!text.starts_with("PK\x03\x04")) return;
  throw InputError(
      ErrorCode::wrong_type,
      fmt::format(
          "{}: this is an archive, not a config; the name of an FMU must end in .fmu, the name of an SSP in .ssp",
          file.string()));
}

/// Builds the same JSON as ordered_json::parse(), but does not search for an earlier member with the same name, because
/// this takes 10 s for 100,000 members. data::Document reports such members.
class OrderedBuilder : public nlohmann::json_sax<nlohmann::ordered_json> {
 public:
  using Json = nlohmann::ordered_json;

  Json take() { return std::move(root_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(Json::number_integer_t value) override { return add(value); }
  bool number_unsigned(Json::number_unsigned_t value) override { return add(value); }
  bool number_float(Json::number_float_t value, const std::string& /*text*/) override { return add(value); }
  bool string(std::string& value) override { return add(std::move(value)); }
  bool binary(Json::binary_t& /*value*/) override { return false; }  // JSON text contains no binary values
  bool key(std::string& value) override {
    key_ = std::move(value);
    return true;
  }
  bool start_object(std::size_t /*size*/) override { return open(Json::object()); }
  bool start_array(std::size_t /*size*/) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/, const Json::exception& /*error*/) override {
    return false;
  }

 private:
  Json& put(Json value) {
    if (open_.empty()) return root_ = std::move(value);
    auto& container = *open_.back();
    if (container.is_array()) return container.emplace_back(std::move(value));
    auto& members = container.get_ref<Json::object_t&>();
    return static_cast<Json::object_t::Container&>(members).emplace_back(std::move(key_), std::move(value)).second;
  }
  bool add(Json value) {
    put(std::move(value));
    return true;
  }
  bool open(Json container) {
    open_.push_back(&put(std::move(container)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  Json root_;
  std::vector<Json*> open_;  // a container can move only when its parent gets another member, after it was closed
  std::string key_;
};

nlohmann::ordered_json ordered_json(const std::string& text) {
  OrderedBuilder builder;
  nlohmann::ordered_json::sax_parse(text, &builder);
  return builder.take();
}

nlohmann::ordered_json give(nlohmann::ordered_json config, const GivenTimes& times) {
  if (times.step) std::visit([&](const auto& step) { config["step"] = step; }, *times.step);
  if (times.stop_time_s) config["stop_time"] = *times.stop_time_s;
  return config;
}

SspConfig open_ssp(const std::filesystem::path& file, SystemDescription& system) {
  auto folder = std::make_shared<const modeldesc::TemporaryFolder>("mebots");
  system.unpacked = folder;
  auto notices = modeldesc::unpack(file, folder->path());
  if (const std::string ssd = "SystemStructure.ssd"; !is_file(folder->path() / ssd)) {
    throw InputError(ErrorCode::file_not_found, fmt::format("{}: this is not an SSP: {}", file.string(),
                                                            modeldesc::why_missing(folder->path(), ssd)));
  }
  auto ssp = read_ssp(folder->path(), file, SspReach::inside);
  std::ranges::move(notices, std::back_inserter(ssp.notices));
  return ssp;
}

void read_sections(const data::Node& root, SystemDescription& system) {
  data::Object object(root);
  bool has_instances = true;
  for (const auto& section : kSections) {
    const auto read = [&](const data::Node& node) {
      // If no instance was read, each instance name would be reported as a mistake. Sections that contain instance
      // names are then skipped.
      if (has_instances || !section.names_instances) section.read(node, system);
    };
    if (section.required) {
      object.visit(section.key, read);
    } else {
      object.visit_if(section.key, read);
    }
    if (section.key == "instances") has_instances = !system.instances.empty();
  }
  object.finish();
}

/// Throws InputError if a text is not UTF-8, because FMI requires UTF-8. Paths, and values that were made from paths,
/// may contain any bytes.
void require_utf8(const nlohmann::ordered_json& json, const std::string& file) {
  if (json.is_string() && !is_utf8(json.get_ref<const std::string&>())) {
    throw InputError(ErrorCode::syntax_error,
                     fmt::format("{}: a text in this file is not UTF-8; save the file as UTF-8", file));
  }
  if (!json.is_structured()) return;
  for (const auto& [key, value] : json.items()) {
    require_utf8(key, file);
    require_utf8(value, file);
  }
}

/// Reads a config from generated JSON. `places` contains the places of its parts in the original file.
void read_made_config(LoadedSystem& loaded, const std::string& file, std::map<std::string, std::string> places) {
  require_utf8(loaded.config, file);
  config::Repeats repeats{loaded.system.file.parent_path(), places, {}};
  bool is_expanded = false;
  data::JsonDocument::of(loaded.config, file, std::move(places)).read([&](const data::Node& root) {
    is_expanded = config::has_repeats(root);
    if (is_expanded) {
      config::expand_repeats(root, loaded.config, file, repeats);
    } else {
      read_sections(root, loaded.system);
    }
  });
  if (!is_expanded) return;
  loaded.system.source += repeats.source;  // tables are inputs of the run
  data::JsonDocument::of(loaded.config, file, std::move(repeats.places)).read([&](const data::Node& root) {
    read_sections(root, loaded.system);
  });
}

/// Reads the config that a variant extends. On entry, `loaded.config` is the JSON of the variant. On return, it is the
/// merged config.
void read_extended(LoadedSystem& loaded, const std::string& file, const std::string& base, const GivenTimes& times) {
  const auto base_file = std::filesystem::path(file).parent_path() / base;
  if (!is_there(base_file)) {
    throw InputError(ErrorCode::file_not_found,
                     fmt::format("{}: /{}: there is no {} in the folder of this config", file, config::kExtends, base));
  }
  const auto text = text_of(base_file);
  refuse_archive(text, base_file);
  data::Document(text, base_file.string()).read([](const data::Node& root) {
    if (data::Object(root).has(config::kExtends)) {
      root.at(config::kExtends)
          .fail(ErrorCode::invalid_value, "this file extends another one; extend that one instead");
    }
  });
  auto extended = ordered_json(text);
  auto places = config::places_of(loaded.config, extended);
  loaded.config = give(config::merged(std::move(extended), loaded.config), times);
  loaded.system.source += text;  // both texts are inputs of the run
  read_made_config(loaded, file, std::move(places));
}

/// Selects whether the JSON of the config is also returned, which takes longer.
enum class WithJson : std::uint8_t { yes, no };

void read_config_text(LoadedSystem& loaded, const std::string& file, const GivenTimes& times, WithJson with_json) {
  data::Document document(loaded.system.source, file);
  const bool is_changed = times.step || times.stop_time_s;
  bool is_made = is_changed;
  std::optional<std::string> base;
  config::Repeats repeats{loaded.system.file.parent_path(), {}, {}};
  document.read([&](const data::Node& root) {
    if (root.has(config::kExtends)) {
      base = config::read_variant(root);
    } else if (config::has_repeats(root)) {
      is_made = true;
      loaded.config = ordered_json(loaded.system.source);
      config::expand_repeats(root, loaded.config, file, repeats);
    } else if (!is_changed || !root.is(data::Kind::object)) {
      read_sections(root, loaded.system);
    }
  });
  const bool needs_json = base || is_made || with_json == WithJson::yes;
  if (needs_json && loaded.config.is_null()) loaded.config = ordered_json(loaded.system.source);
  if (base) {
    read_extended(loaded, file, *base, times);
  } else if (is_made) {
    loaded.config = give(std::move(loaded.config), times);
    loaded.system.source += repeats.source;
    read_made_config(loaded, file, std::move(repeats.places));
  }
}

void read_ssp_config(LoadedSystem& loaded, SspConfig ssp, const std::string& file, const GivenTimes& times) {
  loaded.system.notices = std::move(ssp.notices);
  loaded.config = give(std::move(ssp.config), times);
  for (const auto* key : {"step", "stop_time"}) {
    if (loaded.config.contains(key)) continue;
    throw InputError(ErrorCode::missing_key,
                     fmt::format("{}: the system specifies no {}; set it with --{}", file,
                                 key == std::string_view("step") ? "communication step" : "stop time",
                                 key == std::string_view("step") ? "step" : "stop-time"));
  }
  read_made_config(loaded, file, std::move(ssp.places));
}

/// Reads a single FMU as a system. In `system.source`, the path of the FMU is only a file name. The folder is not
/// needed, because the hash of the inputs contains the bytes of the FMU.
void read_single_fmu(LoadedSystem& loaded, const std::filesystem::path& file, const GivenTimes& times) {
  auto& system = loaded.system;
  loaded.config = config::single_fmu_config(file, read_fmu_description(file), times, system.notices);
  auto portable = loaded.config;
  portable["instances"][system.name]["fmu"] = file.filename().string();
  system.source = portable.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  system.single_fmu = true;
  read_made_config(loaded, file.string(), {});
}

LoadedSystem named(std::string source, const std::filesystem::path& file) {
  LoadedSystem loaded;
  loaded.system.source = std::move(source);
  loaded.system.file = std::filesystem::absolute(file);
  loaded.system.name = file.stem().string();
  return loaded;
}

}  // namespace

std::vector<std::string> config_keys() {
  std::vector<std::string> keys;
  for (const auto& section : kSections) keys.emplace_back(section.key);
  keys.insert(keys.end(), {config::kExtends, config::kChanges});
  return keys;
}

LoadedSystem config::load_text(std::string text, const std::filesystem::path& file) {
  auto loaded = named(std::move(text), file);
  refused_as_input([&] { read_config_text(loaded, file.string(), {}, WithJson::yes); });
  return loaded;
}

LoadedSystem config::load_ssp_config(SspConfig ssp, const std::filesystem::path& file, const GivenTimes& times) {
  auto loaded = named({}, file);
  refused_as_input([&] { read_ssp_config(loaded, std::move(ssp), file.string(), times); });
  return loaded;
}

void config::check(const std::filesystem::path& file) {
  auto loaded = named(text_of(file), file);
  refuse_archive(loaded.system.source, file);
  read_config_text(loaded, file.string(), {}, WithJson::no);
}

void config::check_scenario(const std::filesystem::path& file) {
  SystemDescription system;
  system.start_time_ns = -static_cast<std::int64_t>(kLongestTimeS) * kNanosecondsPerSecond;  // the start time is not
                                                                                             // known
  data::Document(file).read(
      [&](const data::Node& root) { read_scenario_file(root, system, std::filesystem::absolute(file).parent_path()); });
}

namespace {

LoadedSystem load(const std::filesystem::path& path, const GivenTimes& times, WithJson with_json) {
  return refused_as_input([&] {
    const auto [file, form] = find_system(path);
    auto loaded = named(form == SystemForm::fmu ? std::string() : text_of(file), file);
    loaded.system.name = system_name(path);
    switch (form) {
      case SystemForm::fmu:
        read_single_fmu(loaded, file, times);
        break;
      case SystemForm::config:
        refuse_archive(loaded.system.source, file);
        read_config_text(loaded, file.string(), times, with_json);
        break;
      case SystemForm::ssp:
        read_ssp_config(loaded, open_ssp(file, loaded.system), file.string(), times);
        break;
      case SystemForm::ssd:
      case SystemForm::osp: {
        const auto folder = std::filesystem::absolute(file).parent_path();
        auto read = form == SystemForm::osp ? read_osp(file)
                                            : read_ssp(folder, folder, SspReach::anywhere, file.filename().string());
        loaded.system.source = read.source;
        read_ssp_config(loaded, std::move(read), file.string(), times);
        break;
      }
    }
    return loaded;
  });
}

}  // namespace

LoadedSystem load_system(const std::filesystem::path& path, const GivenTimes& times) {
  return load(path, times, WithJson::yes);
}

SystemDescription read_config(const std::filesystem::path& path, const GivenTimes& times) {
  return load(path, times, WithJson::no).system;
}

}  // namespace mebots::master
