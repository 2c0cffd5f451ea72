// SPDX-License-Identifier: Apache-2.0
// The section `view`: what the page of a run shows first.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {
namespace {

CurveDescription read_curve(const Node& node, const SystemDescription& system) {
  Object object(node);
  CurveDescription curve;
  curve.place = node.place();
  curve.rate = object.has("rate_of");
  if (curve.rate && object.has("variable")) {
    node.complain(ErrorCode::invalid_value, "a curve is either a 'variable' or the 'rate_of' one");
  }
  object.read(curve.rate ? "rate_of" : "variable", curve.variable, variable_of(system));
  object.read_if("label", curve.label, &Node::readable_text);
  object.allow({"variable"});
  object.finish();
  return curve;
}

PanelDescription read_panel(const Node& node, const SystemDescription& system) {
  static const auto kind_of =
      data::word_of<PanelKind>({{"lines", PanelKind::lines}, {"stack", PanelKind::stack}, {"lanes", PanelKind::lanes}});
  Object object(node);
  PanelDescription panel;
  object.read("title", panel.title, &Node::readable_text);
  object.read_if("kind", panel.kind, kind_of);
  object.read("curves", panel.curves, data::list_of([&](const Node& element) { return read_curve(element, system); }));
  object.finish();
  return panel;
}

}  // namespace

void read_view(const Node& node, SystemDescription& system) {
  Object object(node);
  auto& view = system.view;
  object.visit_if("scene", [&](const Node& scene) {
    view.scene = variable_name(scene, system);
    view.scene_place = scene.place();
  });
  object.read_if("panels", view.panels,
                 data::list_of([&](const Node& element) { return read_panel(element, system); }));
  object.read_if("marks", view.marks, data::list_of([&](const Node& element) {
                   return instance_name(element.readable_text(), element, system);
                 }));
  object.finish();
}

}  // namespace mebots::master::config
