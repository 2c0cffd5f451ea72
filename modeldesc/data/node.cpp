// SPDX-License-Identifier: Apache-2.0
#include "mebots/data/node.hpp"

#include "content.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <limits>

namespace mebots::data {

std::string Limits::text() const {
  const std::string lower = fmt::format("{} {}", min_is_allowed ? ">=" : ">", min);
  if (std::isinf(max)) return std::isinf(min) ? "finite" : lower;
  return fmt::format("{} and <= {}", lower, max);
}

std::string pointer_step(std::string_view key) {
  std::string text = "/";
  for (const char c : key) {
    if (c == '~') {
      text += "~0";
    } else if (c == '/') {
      text += "~1";
    } else {
      text += c;
    }
  }
  return text;
}

std::string pointer_of(const std::vector<Value>& values, std::size_t index) {
  std::vector<std::string> steps;
  for (auto i = index; i != 0; i = values[i].parent) {
    const bool in_list = values[values[i].parent].kind == Kind::list;
    steps.push_back(in_list ? fmt::format("/{}", values[i].position) : pointer_step(values[i].key));
  }
  std::string text;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) text += *step;
  return text;
}

Kind Node::kind() const {
  return document_->content_->values[index_].kind;
}

bool Node::is_integer_literal() const {
  return document_->content_->values[index_].is_literal;
}

std::string Node::text() const {
  if (!is(Kind::text)) fail_kind("a text");
  const auto& text = document_->content_->values[index_].text;
  // Refuses a zero byte, because the text may become a C string, which would end at this byte.
  if (text.find('\0') != std::string::npos) {
    fail(ErrorCode::invalid_value, fmt::format("{} contains a zero byte, where a C string ends; remove it", shown()));
  }
  return text;
}

std::string Node::readable_text() const {
  auto found = text();
  if (found.empty()) fail(ErrorCode::invalid_value, "the text is empty");
  return found;
}

bool Node::flag() const {
  if (!is(Kind::boolean)) fail_kind("true or false");
  return document_->content_->values[index_].flag;
}

double Node::number(const Limits& limits) const {
  if (!is_number()) fail_kind("a number");
  const double value = document_->content_->values[index_].number;
  if (!limits.admit(value)) {
    fail(ErrorCode::value_out_of_range, fmt::format("{} must be {}", shown(), limits.text()));
  }
  return value;
}

std::int64_t Node::whole_number(std::int64_t least, std::int64_t most) const {
  if (!is_number()) fail_kind("a whole number");
  const auto& value = document_->content_->values[index_];
  const bool fits =
      is(Kind::whole_number) && (value.negative || value.whole <= std::numeric_limits<std::int64_t>::max());
  const auto whole = fits ? static_cast<std::int64_t>(value.whole) : 0;
  if (!fits || whole < least || whole > most) {
    fail(ErrorCode::value_out_of_range, fmt::format("{} must be a whole number from {} to {}", shown(), least, most));
  }
  return whole;
}

std::uint64_t Node::natural_number() const {
  const auto& value = document_->content_->values[index_];
  if (!is(Kind::whole_number) || value.negative) fail_kind("a whole number that is not negative");
  return value.whole;
}

std::vector<Node> Node::elements() const {
  if (!is(Kind::list)) fail_kind("a list");
  const auto& values = document_->content_->values;
  std::vector<Node> found;
  for (auto i = index_ + 1; i < values[index_].end; i = values[i].end) found.push_back({*document_, i});
  return found;
}

std::vector<Member> Node::members() const {
  if (!is(Kind::object)) fail_kind("an object");
  const auto& values = document_->content_->values;
  std::vector<Member> found;
  for (auto i = index_ + 1; i < values[index_].end; i = values[i].end) {
    found.push_back({values[i].key, {*document_, i}});
  }
  return found;
}

std::optional<Node> Node::find(std::string_view key) const {
  if (!is(Kind::object)) return std::nullopt;
  const auto& values = document_->content_->values;
  for (auto i = index_ + 1; i < values[index_].end; i = values[i].end) {
    if (values[i].key == key) return Node(*document_, i);
  }
  return std::nullopt;
}

Node Node::at(std::string_view key) const {
  if (!is(Kind::object)) fail_kind("an object");
  const auto found = find(key);
  if (!found) fail(ErrorCode::missing_key, fmt::format("the key '{}' is missing", key));
  return *found;
}

Mistake Node::mistake(ErrorCode code, std::string_view what) const {
  return {code, without_zero_bytes(place()), without_zero_bytes(what), document_->content_->values[index_].offset};
}

void Node::complain(ErrorCode code, std::string_view what) const {
  document_->content_->mistakes.push_back(mistake(code, what));
}

void Node::fail(ErrorCode code, std::string_view what) const {
  throw Mistakes({mistake(code, what)});
}

void Node::fail_kind(std::string_view wanted) const {
  fail(ErrorCode::wrong_type, fmt::format("{} is expected here, not {}", wanted, shown()));
}

void Node::complain_unknown(std::string_view what, std::string_view name, std::span<const std::string> known) const {
  attempt([&] { fail_unknown(what, name, known); });
}

void Node::fail_unknown(std::string_view what, std::string_view name, std::span<const std::string> known) const {
  fail(ErrorCode::unknown_name, fmt::format("{} '{}' is unknown. {}", what, name, suggest(name, known)));
}

void Node::note(const Mistakes& mistakes) const {
  auto& all = document_->content_->mistakes;
  for (auto mistake : mistakes.list()) {
    // The mistake is in another file, which this value names. Reports it at the place of this value.
    if (!mistake.place.starts_with(document_->content_->name)) {
      mistake.offset = document_->content_->values[index_].offset;
    }
    all.push_back(std::move(mistake));
  }
}

std::size_t Node::noted() const {
  return document_->content_->mistakes.size();
}

std::string Node::shown() const {
  constexpr std::size_t kLongest = 60;
  const auto& value = document_->content_->values[index_];
  std::string text;
  switch (value.kind) {
    case Kind::null:
      return "null";
    case Kind::boolean:
      return value.flag ? "true" : "false";
    case Kind::whole_number:
      return value.negative ? fmt::format("{}", static_cast<std::int64_t>(value.whole))
                            : fmt::format("{}", value.whole);
    case Kind::number:
      return fmt::format("{}", value.number);
    case Kind::text:
      text = nlohmann::json(value.text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
      break;
    case Kind::list:
      text = "[";
      for (const auto& element : elements()) {
        if (text.size() > 1) text += ", ";
        if (text.size() > kLongest) break;
        text += element.shown();
      }
      text += ']';
      break;
    case Kind::object:
      text = "{";
      for (const auto& [key, member] : members()) {
        if (text.size() > 1) text += ", ";
        if (text.size() > kLongest) break;
        text +=
            nlohmann::json(key).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + ": " + member.shown();
      }
      text += '}';
      break;
  }
  if (text.size() > kLongest) {
    auto end = kLongest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // so as not to cut a character
    text = text.substr(0, end) + "...";
  }
  return text;
}

std::string Node::pointer() const {
  return pointer_of(document_->content_->values, index_);
}

std::string Node::place() const {
  const auto& content = *document_->content_;
  const auto path = pointer();
  const auto shown_path = path.empty() ? std::string("/") : path;
  if (content.lines) {
    return fmt::format("{}{}: {}", content.name, content.lines->place(content.values[index_].offset), shown_path);
  }
  for (auto outer = path;; outer.resize(outer.rfind('/'))) {
    if (const auto found = content.places.find(outer); found != content.places.end()) {
      return fmt::format("{}: {}: {}", content.name, found->second, shown_path);
    }
    if (outer.empty()) return fmt::format("{}: {}", content.name, shown_path);
  }
}

}  // namespace mebots::data
