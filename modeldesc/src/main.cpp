// SPDX-License-Identifier: Apache-2.0
// The program mebots-modeldesc, which generates files from an FMU's description and packs them into the archive.
#include "command_line/command.hpp"
#include "description.hpp"
#include "generate.hpp"
#include "mebots/error.hpp"
#include "mebots/text_file.hpp"
#include "pack_fmu.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

std::vector<std::string> lines_of(const std::string& file) {
  std::istringstream text(mebots::text_of(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace mebots::modeldesc;
  CLI::App app{"Generates the files of an FMU from its description, and packs them"};
  app.set_version_flag("--version", "mebots-modeldesc " MEBOTS_VERSION);
  app.require_subcommand(1);

  std::string description;
  std::string board;
  std::string folder;
  CLI::App* generate_command =
      app.add_subcommand("generate", "Write modelDescription.xml, index.html and the C++ files");
  generate_command->add_option("description", description, "description.json of the FMU")
      ->type_name("FILE.json")
      ->required();
  generate_command->add_option("--board", board, "board file whose devices' variables are added")
      ->type_name("FILE.json");
  std::vector<int> versions;
  bool has_icon = false;
  std::size_t copies = 1;
  generate_command
      ->add_option("--fmi", versions,
                   "version of FMI, 2 or 3 (may be repeated); with both, the files of 3.0 go to FOLDER/fmi3. Default: "
                   "the description's")
      ->check(CLI::IsMember({2, 3}));
  generate_command->add_flag("--icon", has_icon, "declare the picture of the archive (pack --icon) in FMI 3.0");
  generate_command
      ->add_option("--count", copies, "copies of the object that the description repeats, such as drones (default 1)")
      ->check(CLI::Range(1, 4096));
  std::string fmi2_sources;
  std::string fmi3_sources;
  generate_command
      ->add_option("--fmi2-sources", fmi2_sources, "list of the sources in the archive to compile, one a line")
      ->type_name("FILE.txt");
  generate_command->add_option("--fmi3-sources", fmi3_sources, "the same for FMI 3.0: writes buildDescription.xml")
      ->type_name("FILE.txt");
  generate_command->add_option("--out", folder, "folder to write to")->type_name("FOLDER")->required();
  generate_command->callback([&] {
    GenerateOptions options;
    options.has_icon = has_icon;
    if (!fmi2_sources.empty()) options.fmi2_sources = lines_of(fmi2_sources);
    if (!fmi3_sources.empty()) options.fmi3_sources = lines_of(fmi3_sources);
    for (const int version : versions) options.fmi.push_back(static_cast<FmiVersion>(version));
    generate(read_description(description, board, copies), folder, options);
  });

  std::string archive;
  FmuParts parts;
  CLI::App* pack_command = app.add_subcommand("pack", "Write an .fmu archive");
  pack_command->add_option("archive", archive, "the .fmu to write")->type_name("FILE.fmu")->required();
  pack_command->add_option("--description", parts.description, "modelDescription.xml")
      ->type_name("FILE.xml")
      ->required();
  pack_command->add_option("--documentation", parts.documentation, "index.html")->type_name("FILE.html")->required();
  pack_command->add_option("--binary", parts.binary, "shared library of the FMU, for Linux or Windows")
      ->type_name("FILE")
      ->required();
  pack_command->add_option("--library", parts.libraries, "library to pack next to it (may be repeated)")
      ->type_name("FILE");
  pack_command
      ->add_option("--resources", parts.resource_folders, "folder whose contents go to resources/ (may be repeated)")
      ->type_name("FOLDER");
  pack_command->add_option("--resource-file", parts.resource_files, "file that goes to resources/ (may be repeated)")
      ->type_name("FILE");
  pack_command
      ->add_option("--icon", parts.icon, "picture that becomes model.png; in FMI 3.0, terminalsAndIcons/icon.png")
      ->type_name("FILE.png");
  pack_command->add_option("--terminals", parts.terminals, "terminalsAndIcons.xml of FMI 3.0; not packed if empty")
      ->type_name("FILE.xml");
  pack_command->add_option("--license", parts.license, "licence text of the FMU")->type_name("FILE");
  pack_command->add_option("--license-id", parts.license_id, "licence of the FMU, as an SPDX expression")
      ->type_name("EXPRESSION");
  pack_command
      ->add_option("--parts", parts.parts, "list of third-party parts, for their licences and the bill of materials")
      ->type_name("FILE");
  pack_command->add_option("--sources", parts.sources, "folder whose contents go to sources/")->type_name("FOLDER");
  pack_command->add_option("--reference", parts.reference, "folder with reference traces")->type_name("FOLDER");
  pack_command->callback([&] { pack_fmu(archive, parts); });

  Product product;
  std::vector<std::string> part_lists;
  std::string bill;
  CLI::App* sbom_command = app.add_subcommand("sbom", "Write a bill of materials (SPDX 2.3 JSON)");
  sbom_command->add_option("file", bill, "the file to write")->type_name("FILE.json")->required();
  sbom_command->add_option("--name", product.name, "name of the product that the bill describes")
      ->type_name("NAME")
      ->required();
  sbom_command->add_option("--product-version", product.version, "version of the product")->type_name("VERSION");
  sbom_command->add_option("--license-id", product.license, "licence of the product, as an SPDX expression")
      ->type_name("EXPRESSION");
  sbom_command->add_option("--parts", part_lists, "lists of third-party parts (may be repeated)")
      ->type_name("FILE")
      ->required();
  sbom_command->callback([&] {
    std::vector<Part> others;
    for (const auto& list : part_lists) {
      for (auto& part : read_parts(list)) others.push_back(std::move(part));
    }
    write_text_file(bill, spdx_document(product, std::move(others)));
  });

  app.name("mebots-modeldesc");
  if (const auto code = mebots::command_line::handle_hidden_options(app, MEBOTS_VERSION, argc, argv)) return *code;
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const mebots::Error& error) {
    fmt::print(stderr, "mebots-modeldesc: {}\n", error.what());
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "mebots-modeldesc: unexpected: {}\n", error.what());
    return 1;
  }
}
