// SPDX-License-Identifier: Apache-2.0
#include "xml_file.hpp"

#include "files.hpp"
#include "mebots/input_error.hpp"
#include "model/fmu_kind.hpp"
#include "values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <set>

namespace mebots::master::ssp {
namespace {

constexpr std::string_view kFmu = "application/x-fmu-sharedlibrary";
constexpr std::string_view kDefinition = "application/x-ssp-definition";

/// The SSDs that are being read. Each SSD is the source of a component in the SSD before it.
struct Nesting {
  std::vector<std::filesystem::path> open;
  // Total number of SSDs. A few files that refer to each other could otherwise multiply without limit.
  std::size_t read = 0;
};

constexpr std::size_t kMostDefinitions = 10'000;
constexpr std::size_t kDeepestDefinition = 100;  // maximum nesting of SSDs, because the readers are recursive

struct KindName {
  std::string_view name;
  ConnectorKind kind;
};

constexpr KindName kKinds[] = {
    {"input", ConnectorKind::input},
    {"output", ConnectorKind::output},
    {"parameter", ConnectorKind::parameter},
    {"structuralParameter", ConnectorKind::structural_parameter},
    {"calculatedParameter", ConnectorKind::calculated_parameter},
    {"constant", ConnectorKind::constant},
    {"local", ConnectorKind::local},
    {"inout", ConnectorKind::inout},
    {"unspecified", ConnectorKind::unspecified},
};

class SystemReader {
 public:
  SystemReader(const Source& source, const XmlFile& file, Nesting& nesting)
      : source_(source), file_(file), definitions_(read_definitions(file, file.root())), nesting_(nesting) {}

  Element read_system(pugi::xml_node node) const {
    auto system = read_common(node, Element::Kind::system);
    std::set<std::string> names;
    for (const auto child_node : child(node, "Elements").children()) {
      if (child_node.type() != pugi::node_element) continue;
      auto element = read_element(child_node);
      if (!names.insert(element.name).second) {
        file_.fail(child_node, fmt::format("the name \"{}\" occurs twice", element.name));
      }
      system.elements.push_back(std::move(element));
    }
    for (const auto connection : children(child(node, "Connections"), "Connection")) {
      system.connections.push_back(read_connection(connection, names));
    }
    system.parameters = read_parameter_bindings({source_, file_, definitions_, {}}, node);
    return system;
  }

 private:
  Element read_element(pugi::xml_node node) const {
    const auto kind = local_name(node);
    if (file_.required(node, "name").empty()) file_.fail(node, "the name is empty");
    if (kind == "System") return read_system(node);
    if (kind == "Component") return read_component(node);
    file_.fail(node, fmt::format("{} is not supported; use components and systems", kind));
  }

  Element read_common(pugi::xml_node node, Element::Kind kind) const {
    Element element;
    element.kind = kind;
    element.name = node.attribute("name").value();
    element.description = node.attribute("description").value();
    element.place = file_.place(node);
    for (const auto connector : children(child(node, "Connectors"), "Connector")) {
      element.connectors.push_back(read_connector(connector));
    }
    return element;
  }

  Connector read_connector(pugi::xml_node node) const {
    Connector connector;
    connector.name = file_.required(node, "name");
    connector.place = file_.place(node);
    const auto kind = std::string_view(node.attribute("kind").as_string("unspecified"));
    const auto* const known = std::ranges::find(kKinds, kind, &KindName::name);
    if (known == std::end(kKinds)) file_.fail(node, fmt::format("\"{}\" is not a kind of connector", kind));
    connector.kind = known->kind;
    for (const auto type : node.children()) {
      if (auto unit = read_unit(type, definitions_)) connector.unit = std::move(unit);
      if (local_name(type) != "Enumeration") continue;
      const auto items = definitions_.enumerations.find(std::string_view(type.attribute("name").value()));
      if (items != definitions_.enumerations.end()) connector.items = items->second;
    }
    return connector;
  }

  std::string fmu_kind(pugi::xml_node node, std::string_view implementation) const {
    for (const auto kind : {FmuKind::co_simulation, FmuKind::model_exchange}) {
      if (implementation == element_of(kind)) return std::string(word_of(kind));
    }
    if (implementation == "any") return {};
    file_.fail(node, fmt::format("the implementation {} is not supported; use CoSimulation, ModelExchange or any",
                                 implementation));
  }

  Element read_component(pugi::xml_node node) const {
    const std::string type = node.attribute("type").as_string(std::string(kFmu).c_str());
    const auto* const name = node.attribute("name").value();
    if (!node.attribute("source")) {
      file_.fail(node, fmt::format("\"{}\" has no source, so there is nothing to simulate", name));
    }
    if (type == kDefinition) return read_definition(node);
    if (type != kFmu) {
      file_.fail(node, fmt::format("\"{}\" is of type {}; FMUs ({}) and SSDs ({}) can be used", name, type, kFmu,
                                   kDefinition));
    }
    const auto implementation = std::string_view(node.attribute("implementation").as_string("any"));
    auto component = read_common(node, Element::Kind::component);
    component.fmu_kind = fmu_kind(node, implementation);
    const auto* const uri = node.attribute("source").value();
    component.fmu = resolve_uri(source_, file_, node, uri);
    const auto named = parse_file_uri(uri);
    if (named && named->by_proxy) {
      component.in_own_process = true;
      source_.notices.push_back(
          fmt::format("{}: \"{}\" runs on this machine, in its own process; the proxy at {} is not used",
                      component.place, name, *named->by_proxy));
    }
    component.parameters = read_parameter_bindings({source_, file_, definitions_, component.fmu}, node);
    return component;
  }

  /// Reads the system of another SSD in place of a component. Appends the parameter values of the component to those of
  /// the system. Later values override earlier ones (5.3.3).
  Element read_definition(pugi::xml_node node) const {
    const auto path = resolve_uri(source_, file_, node, node.attribute("source").value());
    if (std::ranges::find(nesting_.open, path) != nesting_.open.end()) {
      file_.fail(node, fmt::format("the SSD {} refers to itself", path.string()));
    }
    if (++nesting_.read > kMostDefinitions || nesting_.open.size() >= kDeepestDefinition) {
      file_.fail(node, fmt::format("there are more than {} references to other SSDs, or more than {} nested ones",
                                   kMostDefinitions, kDeepestDefinition));
    }
    const Source inner{source_.files, source_.archive, path.parent_path(), source_.notices};
    auto system = read_document_at(inner, path, nesting_).system;
    auto here = read_common(node, Element::Kind::system);
    system.name = here.name;
    if (!here.description.empty()) system.description = here.description;
    auto parameters = read_parameter_bindings({source_, file_, definitions_, {}}, node);
    std::ranges::move(parameters, std::back_inserter(system.parameters));
    return system;
  }

  ConnectionEnd read_end(pugi::xml_node node, const std::string& side, const std::set<std::string>& names) const {
    // Some tools write an empty element name for a connector of the system.
    ConnectionEnd end{node.attribute((side + "Element").c_str()).value(),
                      file_.required(node, (side + "Connector").c_str())};
    if (const auto indices = node.attribute((side + "Indices").c_str())) {
      end.connector += fmt::format("[{}]", fmt::join(words_of(indices.value()), ","));
      end.has_indices = true;
    }
    if (!end.element.empty() && !names.contains(end.element)) {
      file_.fail(node, fmt::format("there is no element \"{}\" in this system", end.element));
    }
    return end;
  }

  Connection read_connection(pugi::xml_node node, const std::set<std::string>& names) const {
    Connection connection;
    connection.start = read_end(node, "start", names);
    connection.end = read_end(node, "end", names);
    connection.transformation = read_transformation(file_, node);
    connection.description = node.attribute("description").value();
    connection.place = file_.place(node);
    return connection;
  }

 public:
  static Document read_document_at(const Source& source, const std::filesystem::path& ssd, Nesting& nesting) {
    auto file =
        std::make_shared<const XmlFile>(source.files.read(ssd), fmt::format("{}: {}", source.archive, ssd.string()));
    const auto root = file->root();
    if (local_name(root) != "SystemStructureDescription") {
      file->fail(root, "the root element must be SystemStructureDescription");
    }
    const auto version = file->required(root, "version");
    if (version != "1.0" && version != "2.0") {
      file->fail(root, fmt::format("this is SSP {}; only 1.0 and 2.0 are supported", version));
    }
    const auto system = child(root, "System");
    if (!system) file->fail(root, "the element System is missing");
    nesting.open.push_back(ssd);
    Document document{file, SystemReader(source, *file, nesting).read_system(system)};
    nesting.open.pop_back();
    return document;
  }

 private:
  const Source& source_;
  const XmlFile& file_;
  Definitions definitions_;
  Nesting& nesting_;
};

}  // namespace

Document read_document(const Source& source, const std::filesystem::path& ssd) {
  Nesting nesting;
  return SystemReader::read_document_at(source, ssd, nesting);
}

}  // namespace mebots::master::ssp
