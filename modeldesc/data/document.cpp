// SPDX-License-Identifier: Apache-2.0
#include "mebots/data/document.hpp"
#include "mebots/json_document.hpp"

#include "content.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace mebots::data {
namespace {

constexpr std::size_t kMostLines = 20;

std::string text_of_all(const std::vector<Mistake>& mistakes) {
  std::string text;
  for (std::size_t i = 0; i < std::min(mistakes.size(), kMostLines); ++i) {
    if (i > 0) text += '\n';
    text += mistakes[i].place + ": " + mistakes[i].text;
  }
  if (mistakes.size() > kMostLines) text += fmt::format("\nand {} more", mistakes.size() - kMostLines);
  return text;
}

}  // namespace

std::string without_zero_bytes(std::string_view text) {
  std::string written;
  for (const char byte : text) {
    if (byte == '\0') {
      written += "\\u0000";
    } else {
      written += byte;
    }
  }
  return written;
}

Mistakes::Mistakes(std::vector<Mistake> mistakes)
    : Error(mistakes.at(0).code, text_of_all(mistakes)), mistakes_(std::move(mistakes)) {}

Document::Document(const std::filesystem::path& file) : Document(text_of(file), file.string()) {}

Document::Document(std::string_view text, std::string name) : content_(std::make_unique<Content>()) {
  content_->name = std::move(name);
  content_->lines = TextLines(std::string(text));
  content_->values = parse(text, content_->name, *content_->lines, content_->mistakes);
}

Document::Document(std::unique_ptr<Content> content) : content_(std::move(content)) {}

Document JsonDocument::of(const nlohmann::ordered_json& value, std::string name, Places places) {
  auto content = std::make_unique<Document::Content>();
  content->name = std::move(name);
  content->places = std::move(places);
  content->values = values_of(value);
  return Document(std::move(content));
}

Document::~Document() = default;

Node Document::root() {
  return {*this, 0};
}

void Document::check() {
  if (content_->mistakes.empty()) return;
  auto mistakes = std::exchange(content_->mistakes, {});
  std::ranges::stable_sort(mistakes, {}, &Mistake::offset);
  throw Mistakes(std::move(mistakes));
}

}  // namespace mebots::data
