// SPDX-License-Identifier: Apache-2.0
#include "report/page.hpp"

#include "base/installation.hpp"
#include "base/packed.hpp"
#include "mebots/error.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <string_view>

namespace mebots::master::report {
namespace {

/// Escapes text for an HTML element.
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

/// Replaces the single `{{name}}` in the page by `text`.
void put(std::string& page, std::string_view name, std::string_view text) {
  const auto place = fmt::format("{{{{{}}}}}", name);
  const auto at = page.find(place);
  if (at == std::string::npos) {
    throw Error(ErrorCode::system_failure,
                fmt::format("page.html lacks the placeholder for {}; install MEbots again", place));
  }
  page.replace(at, place.size(), text);
}

/// Returns a page with the script and `data` in it. `connect`: the source of the policy from which it may fetch more.
std::string fill(const PageParts& parts, const std::string& title, std::string_view connect, std::string_view data) {
  auto page = parts.frame;
  put(page, "title", escaped(title + " - MEbots"));
  put(page, "connect", connect);
  put(page, "style", parts.style);
  put(page, "script", base64(deflated(parts.script, Packing::small)));
  put(page, "data", data);
  return page;
}

std::string title_of(std::span<const RunFolder> runs) {
  std::string title;
  for (const auto& run : runs) title += (title.empty() ? "" : ", ") + run.name;
  return title;
}

PageParts read_parts(const std::string& name) {
  std::filesystem::path folder;
  try {
    folder = own_data("web");
  } catch (const Error&) {
    throw Error(ErrorCode::not_offered,
                "this mebots was built without pages: run scripts/setup.sh, which installs npm, and build with "
                "-DMEBOTS_PAGES=ON");
  }
  return {text_of(folder / "page.html"), text_of(folder / (name + ".js")), text_of(folder / (name + ".css"))};
}

}  // namespace

PageParts read_page_parts() {
  return read_parts("page");
}

PageParts read_data_page_parts() {
  return read_parts("report");
}

std::string make_page(const PageParts& parts, std::span<const RunFolder> runs) {
  return fill(parts, title_of(runs), "'none'", base64(deflated(payload_of(runs), Packing::small)));
}

std::string make_data_page(const PageParts& parts, const std::string& title, std::string_view data) {
  return fill(parts, title, "'none'", base64(deflated(data, Packing::small)));
}

std::string make_live_page(const PageParts& parts, const std::string& name) {
  return fill(parts, name, "'self'", "");
}

}  // namespace mebots::master::report
