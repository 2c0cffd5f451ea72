// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/xml.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>

namespace mebots::modeldesc {
namespace {

/// Determines the encoding from the byte order mark, or from the bytes of the first "<". Returns an empty text if the
/// encoding is a superset of ASCII.
std::string_view wide_encoding(std::string_view bytes) {
  using namespace std::string_view_literals;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kStarts = {{
      {"\xFF\xFE\0\0"sv, "UTF-32LE"},
      {"\0\0\xFE\xFF"sv, "UTF-32BE"},
      {"<\0\0\0"sv, "UTF-32LE"},
      {"\0\0\0<"sv, "UTF-32BE"},
      {"\xFF\xFE"sv, "UTF-16LE"},
      {"\xFE\xFF"sv, "UTF-16BE"},
      {"<\0"sv, "UTF-16LE"},
      {"\0<"sv, "UTF-16BE"},
  }};
  for (const auto& [start, encoding] : kStarts) {
    if (bytes.starts_with(start)) return encoding;
  }
  return {};
}

/// Returns the encoding in `<?xml ... encoding="..."?>`; empty if the text declares no encoding.
std::string declared_encoding(std::string_view text) {
  if (!text.starts_with("<?xml")) return {};
  const auto declaration = text.substr(0, std::min(text.find("?>"), text.size()));
  const auto at = declaration.find("encoding");
  const auto open = at == std::string_view::npos ? at : declaration.find_first_of("\"'", at);
  if (open == std::string_view::npos) return {};
  const auto close = declaration.find(declaration[open], open + 1);
  return std::string(declaration.substr(open + 1, close == std::string_view::npos ? close : close - open - 1));
}

class Converter {
 public:
  explicit Converter(const std::string& from) : handle_(iconv_open("UTF-8", from.c_str())) {}
  ~Converter() {
    if (known()) iconv_close(handle_);
  }
  Converter(const Converter&) = delete;
  Converter& operator=(const Converter&) = delete;

  // NOLINTNEXTLINE(performance-no-int-to-ptr): so iconv_open says that it failed
  bool known() const { return handle_ != reinterpret_cast<iconv_t>(-1); }

  /// Converts bytes to UTF-8 and appends them to `text`. Returns false if the bytes are invalid in their encoding.
  bool convert(std::string_view bytes, std::string& text) {
    std::array<char, 65536> buffer;              // NOLINT(cppcoreguidelines-pro-type-member-init): filled by iconv
    auto* in = const_cast<char*>(bytes.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast): iconv only reads
    auto left = bytes.size();
    while (left > 0) {
      auto* out = buffer.data();
      auto room = buffer.size();
      const auto result = iconv(handle_, &in, &left, &out, &room);
      text.append(buffer.data(), buffer.size() - room);
      if (result == static_cast<std::size_t>(-1) && errno != E2BIG) return false;
    }
    return true;
  }

 private:
  iconv_t handle_;
};

/// Returns the first element below the permitted depth; null if all elements are permitted. Does not use recursion.
pugi::xml_node too_deep(const pugi::xml_document& document) {
  int depth = 0;
  for (auto node = document.first_child(); node;) {
    if (depth > kDeepestXml) return node;
    if (node.first_child()) {
      node = node.first_child();
      ++depth;
      continue;
    }
    while (node && !node.next_sibling()) {
      node = node.parent();
      if (--depth < 0) return {};
    }
    node = node.next_sibling();
  }
  return {};
}

/// Throws Error if the text refers to an entity of the DTD. pugixml would drop the meaning without an error, because it
/// does not expand entities.
void refuse_entities(const pugi::xml_document& document, std::string_view text, std::string_view source) {
  constexpr std::string_view kDefinition = "<!ENTITY";
  constexpr std::string_view kSpace = " \t\r\n";
  for (const auto node : document.children()) {
    if (node.type() != pugi::node_doctype) continue;
    const std::string_view dtd = node.value();
    for (auto at = dtd.find(kDefinition); at != std::string_view::npos; at = dtd.find(kDefinition, at + 1)) {
      const auto first = std::min(dtd.find_first_not_of(kSpace, at + kDefinition.size()), dtd.size());
      const auto last = std::min(dtd.find_first_of(kSpace, first), dtd.size());
      const auto name = dtd.substr(first, last - first);
      const auto used = text.find(fmt::format("&{};", name));
      if (used == std::string_view::npos) continue;
      throw Error(ErrorCode::syntax_error,
                  fmt::format("{}, line {}: the entity &{}; of the DTD is not expanded, as it could multiply or fetch "
                              "files; write its text in its place",
                              source, line_of(text, static_cast<std::ptrdiff_t>(used)), name));
    }
  }
}

/// True for characters that XML 1.0 permits (section 2.2).
bool is_xml_character(std::uint32_t code) {
  return code == 0x9 || code == 0xA || code == 0xD || (code >= 0x20 && code <= 0xD7FF) ||
         (code >= 0xE000 && code <= 0xFFFD) || (code >= 0x10000 && code <= 0x10FFFF);
}

/// Throws Error if a character reference, such as &#xD800;, denotes no character. pugixml would convert any number to
/// bytes.
void refuse_references(std::string_view text, std::string_view source) {
  for (auto at = text.find("&#"); at != std::string_view::npos; at = text.find("&#", at + 1)) {
    const bool hex = text.substr(at + 2).starts_with('x');
    const auto* first = text.data() + at + (hex ? 3 : 2);
    std::uint32_t code = 0;
    const auto [end, error] = std::from_chars(first, text.data() + text.size(), code, hex ? 16 : 10);
    if (end == first || (error == std::errc{} && is_xml_character(code))) continue;
    throw Error(ErrorCode::syntax_error, fmt::format("{}, line {}: &#{}; is not a character of XML", source,
                                                     line_of(text, static_cast<std::ptrdiff_t>(at)),
                                                     std::string_view(hex ? first - 1 : first, end)));
  }
}

}  // namespace

std::string xml_as_utf8(std::string_view bytes, std::string_view source) {
  std::string encoding(wide_encoding(bytes));
  if (encoding.empty()) encoding = declared_encoding(bytes.substr(bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0));
  if (encoding.empty() || bytes.starts_with("\xEF\xBB\xBF")) encoding = "UTF-8";
  Converter converter(encoding);
  if (!converter.known())
    throw Error(ErrorCode::syntax_error, fmt::format("{}, line 1: the encoding \"{}\" is unknown", source, encoding));
  std::string text;
  text.reserve(bytes.size());
  if (!converter.convert(bytes, text)) {
    throw Error(ErrorCode::syntax_error,
                fmt::format("{}, line {}: there are bytes that are not {} text; save the file in UTF-8", source,
                            line_of(text, static_cast<std::ptrdiff_t>(text.size())), encoding));
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  return text;
}

std::optional<std::uint32_t> first_no_xml_character(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    std::uint32_t code = static_cast<unsigned char>(text[at++]);
    const int more = code < 0xC0 ? 0 : code < 0xE0 ? 1 : code < 0xF0 ? 2 : 3;  // further bytes, six bits each
    if (more > 0) code &= 0x3FU >> more;
    for (int i = 0; i < more && at < text.size(); ++i)
      code = code << 6 | (static_cast<unsigned char>(text[at++]) & 0x3FU);
    if (!is_xml_character(code)) return code;
  }
  return std::nullopt;
}

void parse_xml(pugi::xml_document& document, std::string_view text, std::string_view source) {
  const auto result =
      document.load_buffer(text.data(), text.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result) {
    throw Error(ErrorCode::syntax_error, fmt::format("{}, line {}: not well-formed XML: {}", source,
                                                     line_of(text, result.offset), result.description()));
  }
  refuse_entities(document, text, source);
  refuse_references(text, source);
  if (const auto node = too_deep(document)) {
    throw Error(ErrorCode::syntax_error, fmt::format("{}, line {}: elements are nested more than {} levels deep",
                                                     source, line_of(text, node.offset_debug()), kDeepestXml));
  }
}

std::ptrdiff_t line_of(std::string_view text, std::ptrdiff_t offset) {
  const auto end = std::clamp<std::ptrdiff_t>(offset, 0, std::ssize(text));
  return 1 + std::count(text.begin(), text.begin() + end, '\n');
}

std::vector<std::string> words_of(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  std::vector<std::string> words;
  for (auto at = text.find_first_not_of(kSpace); at != std::string_view::npos;) {
    const auto end = std::min(text.find_first_of(kSpace, at), text.size());
    words.emplace_back(text.substr(at, end - at));
    at = text.find_first_not_of(kSpace, end);
  }
  return words;
}

}  // namespace mebots::modeldesc
