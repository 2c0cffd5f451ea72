// SPDX-License-Identifier: Apache-2.0
#include "report/page.hpp"

#include "base/installation.hpp"
#include "mebots/error.hpp"

#include <string_view>

namespace mebots::master::report {
namespace {

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
  return mebots::read_page_parts(folder, name);
}

}  // namespace

PageParts read_page_parts() {
  return read_parts("page");
}

PageParts read_data_page_parts() {
  return read_parts("report");
}

std::string make_page(const PageParts& parts, std::span<const RunFolder> runs) {
  return fill_page(parts, title_of(runs), payload_of(runs));
}

std::string make_data_page(const PageParts& parts, const std::string& title, std::string_view data) {
  return fill_page(parts, title, data);
}

std::string make_live_page(const PageParts& parts, const std::string& name) {
  return fill_live_page(parts, name);
}

}  // namespace mebots::master::report
