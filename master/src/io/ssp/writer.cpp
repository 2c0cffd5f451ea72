// SPDX-License-Identifier: Apache-2.0
#include "base/time.hpp"
#include "io/ssp/ssp.hpp"
#include "mebots/assert.hpp"
#include "mebots/modeldesc/archive.hpp"

#include "connector_writer.hpp"
#include "definitions_writer.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <fstream>
#include <set>

namespace mebots::master {
namespace {

using namespace ssp;
using modeldesc::Type;
using Json = nlohmann::ordered_json;

/// Returns a unique file name for each FMU. Adds numbers to equal names of files in different folders.
std::map<std::filesystem::path, std::string> file_names(const SystemDescription& system) {
  std::map<std::filesystem::path, std::string> names;
  std::set<std::string> taken;
  for (const auto& instance : system.instances) {
    if (names.count(instance.fmu_path) != 0) continue;
    auto name = instance.fmu_path.filename().string();
    for (int number = 2; !taken.insert(name).second; ++number) {
      name = fmt::format("{}_{}{}", instance.fmu_path.stem().string(), number, instance.fmu_path.extension().string());
    }
    names[instance.fmu_path] = name;
  }
  return names;
}

std::string as_uri(const std::string& name) {
  constexpr std::string_view kPlain = "-._~()[]";
  std::string uri;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       kPlain.find(c) != std::string_view::npos;
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

class SspWriter {
 public:
  SspWriter(const ResolvedSystem& system, const Json& config)
      : system_(system), config_(config), version_(written_version(system)), connectors_(system) {}

  pugi::xml_document& write() {
    auto root = document_.append_child("ssd:SystemStructureDescription");
    const std::pair<const char*, const char*> namespaces[] = {
        {"xmlns:ssc", "http://ssp-standard.org/SSP1/SystemStructureCommon"},
        {"xmlns:ssd", "http://ssp-standard.org/SSP1/SystemStructureDescription"},
        {"xmlns:oms", "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"}};
    for (const auto& [name, uri] : namespaces) root.append_attribute(name) = uri;
    root.append_attribute("name") = system_.description->name.c_str();
    root.append_attribute("version") = version_;
    root.append_attribute("generationTool") = "MEbots " MEBOTS_VERSION;
    auto system = root.append_child("ssd:System");
    system.append_attribute("name") = "root";
    auto elements = system.append_child("ssd:Elements");
    write_connections(system);  // connections determine the connectors, which must be known first
    write_elements(elements);
    write_annotations(system.append_child("ssd:Annotations"));
    definitions_.write(root, "ssd:");
    auto experiment = root.append_child("ssd:DefaultExperiment");
    experiment.append_attribute("startTime") =
        fmt::format("{}", to_seconds(system_.description->start_time_ns)).c_str();
    experiment.append_attribute("stopTime") =
        fmt::format("{}", system_.description->grid().time_s(system_.description->stop_time_ns)).c_str();
    return document_;
  }
  /// Returns the parameter sets for write(). The keys are file names in resources/.
  const std::map<std::string, pugi::xml_document>& parameter_sets() const { return parameter_sets_; }

 private:
  void write_elements(pugi::xml_node elements) {
    const auto files = file_names(*system_.description);
    for (std::size_t i = 0; i < system_.instances.size(); ++i) {
      const auto& instance = system_.instances[i];
      const auto& name = instance.description->name;
      auto component = elements.append_child("ssd:Component");
      component.append_attribute("name") = name.c_str();
      component.append_attribute("type") = "application/x-fmu-sharedlibrary";
      component.append_attribute("source") = ("resources/" + as_uri(files.at(instance.description->fmu_path))).c_str();
      component.append_attribute("implementation") = std::string(element_of(instance.kind)).c_str();
      const auto& keys = config_.at("instances").at(name);
      if (keys.contains("text")) {
        component.append_attribute("description") = keys.at("text").get<std::string>().c_str();
      }
      connectors_.write(component, i, definitions_);
      write_parameters(component, instance);
    }
  }

  void write_parameters(pugi::xml_node component, const ResolvedInstance& instance) {
    if (instance.starts.empty() && instance.structural.empty()) return;
    const auto name = free_name(instance.description->name);
    component.append_child("ssd:ParameterBindings").append_child("ssd:ParameterBinding").append_attribute("source") =
        ("resources/" + name).c_str();
    write_parameter_set(instance, version_, parameter_sets_[name]);
  }

  /// Returns a unique file name without special characters.
  std::string free_name(const std::string& instance) const {
    std::string stem = instance;
    for (auto& c : stem) {
      const bool plain =
          (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
      if (!plain) c = '_';
    }
    auto name = stem + ".ssv";
    for (int number = 2; parameter_sets_.contains(name); ++number) name = fmt::format("{}_{}.ssv", stem, number);
    return name;
  }

  /// True if SSP cannot express the connection. The annotation then contains it.
  static bool is_own(const ConnectionDescription& connection) { return connection.sum || connection.narrow; }

  /// Writes the connections. A connection of OSMP binaries becomes three connections.
  void write_connections(pugi::xml_node system) {
    if (system_.description->connections.empty()) return;
    auto connections = system.append_child("ssd:Connections");
    const auto& written = config_.at("connections");
    for (std::size_t i = 0; i < system_.description->connections.size(); ++i) {
      const auto& connection = system_.description->connections[i];
      if (is_own(connection)) continue;
      const auto text = written.at(i).value("text", std::string());
      for (const auto& [start, end] : connectors_.ends(connection)) {
        auto node = connections.append_child("ssd:Connection");
        write_end(node, "start", start);
        write_end(node, "end", end);
        if (!connection.convert_units) node.append_attribute("suppressUnitConversion") = "true";
        if (!text.empty()) node.append_attribute("description") = text.c_str();
        write_transformation(node, connection);
      }
    }
    if (!connections.first_child()) system.remove_child(connections);
  }

  void write_end(pugi::xml_node node, const std::string& side, const WrittenEnd& end) const {
    const auto& name = system_.instances[end.instance].description->name;
    node.append_attribute((side + "Element").c_str()) = name.c_str();
    node.append_attribute((side + "Connector").c_str()) = end.connector.c_str();
    if (!end.indices.empty()) node.append_attribute((side + "Indices").c_str()) = end.indices.c_str();
  }

  /// Returns the resolved connection of `connection`, which must have a map. If it connects arrays, returns the
  /// connection of their first elements.
  const ResolvedConnection& resolved_map(const ConnectionDescription& connection) const {
    const auto fits = [&](const ResolvedConnection& one) {
      const auto& variable = *one.to.variable;
      const auto& element = variable.fmi3->element;
      return system_.instances[one.to.instance].description->name == connection.to.instance && !one.map.empty() &&
             (variable.name == connection.to.variable || (element && element->array == connection.to.variable));
    };
    const auto in = [&](const std::vector<ResolvedConnection>& list) -> const ResolvedConnection* {
      const auto found = std::ranges::find_if(list, fits);
      return found == list.end() ? nullptr : &*found;
    };
    const auto* found = in(system_.connections);
    for (const auto& group : system_.clock_groups) found = found != nullptr ? found : in(group.connections);
    for (const auto& group : system_.continuous_systems) found = found != nullptr ? found : in(group.clock_connections);
    MEBOTS_ASSERT(found != nullptr, "every connection of the description is resolved");
    return *found;
  }

  void write_transformation(pugi::xml_node node, const ConnectionDescription& connection) const {
    if (connection.factor != 1 || connection.offset != 0) {
      auto linear = node.append_child("ssc:LinearTransformation");
      linear.append_attribute("factor") = fmt::format("{}", connection.factor).c_str();
      linear.append_attribute("offset") = fmt::format("{}", connection.offset).c_str();
    }
    if (connection.map.empty()) return;
    const auto& resolved = resolved_map(connection);
    const bool flags = resolved.to.variable->type == Type::boolean;
    auto map = node.append_child(flags ? "ssc:BooleanMappingTransformation" : "ssc:IntegerMappingTransformation");
    for (const auto& pair : resolved.map) {
      const auto text = [&](std::int64_t value) {
        return flags ? std::string(value != 0 ? "true" : "false") : fmt::format("{}", value);
      };
      auto entry = map.append_child("ssc:MapEntry");
      entry.append_attribute("source") = text(pair.from).c_str();
      entry.append_attribute("target") = text(pair.to).c_str();
    }
  }

  void write_annotations(pugi::xml_node annotations) {
    // The annotation contains the sections of the config for which SSP has no elements.
    Json rest = Json::object();
    for (const auto& [key, value] : config_.items()) {
      if (key != "$schema" && key != "instances" && key != "connections" && key != "start_time" && key != "stop_time") {
        rest[key] = value;
      }
    }
    for (std::size_t i = 0; i < system_.description->connections.size(); ++i) {
      if (is_own(system_.description->connections[i])) rest["connections"].push_back(config_.at("connections").at(i));
    }
    for (const auto& [name, keys] : config_.at("instances").items()) {
      for (const auto& [key, value] : keys.items()) {
        if (key != "fmu" && key != "parameters" && key != "text") rest["instances"][name][key] = value;
      }
    }
    // OMSimulator stores the kind and step of a system in its own annotation. This annotation must be the first one,
    // because OMSimulator reads no other.
    auto theirs = annotations.append_child("ssc:Annotation");
    theirs.append_attribute("type") = "org.openmodelica";
    theirs.append_child("oms:Annotations")
        .append_child("oms:SimulationInformation")
        .append_child("oms:FixedStepMaster")
        .append_attribute("stepSize") = fmt::format("{}", to_seconds(system_.description->step)).c_str();
    auto master = theirs.first_child().first_child().first_child();
    master.append_attribute("description") = "oms-ma";
    master.append_attribute("absoluteTolerance") = "0.0001";
    master.append_attribute("relativeTolerance") = "0.0001";
    auto own = annotations.append_child("ssc:Annotation");
    own.append_attribute("type") = std::string(kSspAnnotation).c_str();
    // In SSP 1.0, an annotation may contain only elements, not text.
    auto holder = own.append_child("mebots:Config");
    holder.append_attribute("xmlns:mebots") = fmt::format("urn:{}", kSspAnnotation).c_str();
    holder.text().set(rest.dump(2).c_str());
  }

  const ResolvedSystem& system_;
  const Json& config_;
  const char* version_;
  pugi::xml_document document_;
  ConnectorWriter connectors_;
  DefinitionsWriter definitions_;
  std::map<std::string, pugi::xml_document> parameter_sets_;  // key: file name
};

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: cannot be written; check permissions and free space", file.string()));
}

}  // namespace

void write_ssp(const ResolvedSystem& system, const Json& config, const std::filesystem::path& archive) {
  const modeldesc::TemporaryFolder folder("mebots");
  std::vector<modeldesc::PackedFile> files;
  const auto add = [&](const pugi::xml_document& document, const std::string& entry) {
    const auto file = folder.path() / fmt::format("{}.xml", files.size());
    if (!document.save_file(file.c_str(), "  "))
      throw Error(ErrorCode::file_unwritable, fmt::format("{}: cannot be written", file.string()));
    files.push_back({entry, file});
  };
  SspWriter writer(system, config);
  add(writer.write(), "SystemStructure.ssd");
  for (const auto& [name, set] : writer.parameter_sets()) add(set, "resources/" + name);
  for (const auto& [path, name] : file_names(*system.description)) files.push_back({"resources/" + name, path});
  modeldesc::pack(archive, files);
}

void write_config(const SystemDescription& system, Json config, const std::filesystem::path& file) {
  const auto folder = std::filesystem::path(file.stem().string() + "_fmus");
  const auto target = file.parent_path() / folder;
  std::error_code error;
  std::filesystem::create_directories(target, error);
  if (error)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: the folder cannot be created: {}", target.string(), error.message()));
  const auto names = file_names(system);
  for (const auto& [path, name] : names) {
    std::filesystem::copy_file(path, target / name, std::filesystem::copy_options::overwrite_existing, error);
    if (error)
      throw Error(ErrorCode::file_unwritable,
                  fmt::format("{}: cannot be written: {}", (target / name).string(), error.message()));
  }
  for (const auto& instance : system.instances) {
    config["instances"][instance.name]["fmu"] = (folder / names.at(instance.fmu_path)).string();
  }
  write_text(file, config.dump(2) + "\n");
}

}  // namespace mebots::master
