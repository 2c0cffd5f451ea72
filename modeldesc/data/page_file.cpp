// SPDX-License-Identifier: Apache-2.0
#include "mebots/page_file.hpp"

#include "mebots/base64.hpp"
#include "mebots/error.hpp"
#include "mebots/packed.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <span>

namespace mebots {
namespace {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// Replaces `{{name}}` by `text`. The page must contain `{{name}}` once.
void put(std::string& page, std::string_view name, std::string_view text) {
  const auto place = fmt::format("{{{{{}}}}}", name);
  const auto at = page.find(place);
  if (at == std::string::npos) {
    throw Error(ErrorCode::system_failure,
                fmt::format("page.html lacks the placeholder for {}; install MEbots again", place));
  }
  page.replace(at, place.size(), text);
}

std::string packed_text(std::string_view bytes) {
  const auto packed = deflated(bytes, Packing::small);
  return encode_base64(std::span(reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size()));
}

/// Fills in a page's title, style, script and data. `connect` is the value of `connect-src` in the page's content
/// security policy: the source from which the page may fetch data.
std::string fill(const PageParts& parts, const std::string& title, std::string_view connect, std::string_view data) {
  auto page = parts.frame;
  put(page, "title", escaped(title + " - MEbots"));
  put(page, "connect", connect);
  put(page, "style", parts.style);
  put(page, "script", packed_text(parts.script));
  put(page, "data", data);
  return page;
}

}  // namespace

PageParts read_page_parts(const std::filesystem::path& folder, const std::string& name) {
  return {text_of(folder / "page.html"), text_of(folder / (name + ".js")), text_of(folder / (name + ".css"))};
}

std::string fill_page(const PageParts& parts, const std::string& title, std::string_view data) {
  return fill(parts, title, "'none'", packed_text(data));
}

std::string fill_live_page(const PageParts& parts, const std::string& title) {
  return fill(parts, title, "'self'", "");
}

}  // namespace mebots
