// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/terminals.hpp"
#include "mebots/modeldesc/xml.hpp"

namespace mebots::modeldesc {
namespace {

void add_terminals(pugi::xml_node parent, const std::string& prefix, std::vector<DeclaredTerminal>& terminals) {
  for (const auto node : parent.children("Terminal")) {
    DeclaredTerminal terminal;
    terminal.name = prefix + node.attribute("name").value();
    terminal.kind = node.attribute("terminalKind").value();
    terminal.matching_rule = node.attribute("matchingRule").value();
    terminal.text = node.attribute("description").value();
    for (const auto member : node.children("TerminalMemberVariable"))
      terminal.members.push_back({member.attribute("memberName").value(), member.attribute("variableName").value()});
    const std::string inner_prefix = terminal.name + '.';
    terminals.push_back(std::move(terminal));
    add_terminals(node, inner_prefix, terminals);
  }
}

}  // namespace

std::vector<DeclaredTerminal> read_terminals(std::string_view text, std::string_view source) {
  pugi::xml_document document;
  const std::string utf8 = xml_as_utf8(text, source);
  parse_xml(document, utf8, source);
  std::vector<DeclaredTerminal> terminals;
  add_terminals(document.document_element().child("Terminals"), "", terminals);
  return terminals;
}

}  // namespace mebots::modeldesc
