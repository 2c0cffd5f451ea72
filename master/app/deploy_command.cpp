// SPDX-License-Identifier: Apache-2.0
// `mebots deploy` is written in Python (master/python/mebots/deploy). This program replaces itself by the Python
// interpreter.
#include "command.hpp"
#include "python_words.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

struct DeployOptions {
  std::filesystem::path model;
  std::filesystem::path data;
  std::filesystem::path out;
  std::string board;
  std::string crop;
  std::optional<double> percentile;
  bool equalise = false;
  std::optional<double> input_scale;
  std::optional<double> input_offset;
  std::optional<int> pictures;
  std::optional<int> vectors;
  bool no_measure = false;
  bool json = false;
  std::filesystem::path page;
  std::filesystem::path validate;
  std::filesystem::path labels;
  std::string sizes;
};

Words words_of(const DeployOptions& options) {
  Words words = {options.model.string(), "--data", options.data.string(), "--out", options.out.string()};
  add_word(words, "--board", options.board);
  add_word(words, "--crop", options.crop);
  add_number(words, "--percentile", options.percentile);
  if (options.equalise) words.emplace_back("--equalise");
  add_number(words, "--input-scale", options.input_scale);
  // Joins option and value with "=", because the value may begin with a minus sign.
  if (options.input_offset) words.push_back(fmt::format("--input-offset={}", *options.input_offset));
  add_number(words, "--pictures", options.pictures);
  add_number(words, "--vectors", options.vectors);
  if (options.no_measure) words.emplace_back("--no-measure");
  if (options.json) words.emplace_back("--json");
  add_word(words, "--page", options.page.string());
  add_word(words, "--validate", options.validate.string());
  add_word(words, "--labels", options.labels.string());
  add_word(words, "--sizes", options.sizes);
  return words;
}

}  // namespace

void add_deploy(CLI::App& app, Action& action) {
  const auto options = std::make_shared<DeployOptions>();
  auto* command =
      app.add_subcommand("deploy", "Generate a firmware library from a neural network in ONNX, and measure it");
  command->add_option("model", options->model, "Network: opset 9 to 21, one input, fixed shapes")
      ->type_name("FILE.onnx")
      ->required();
  command
      ->add_option("--data", options->data,
                   "Pictures for the calibration: a folder, or a .npy file of shape [number, channels, ...]")
      ->type_name("PICTURES")
      ->required();
  command->add_option("--out", options->out, "Folder to write; must not exist")->type_name("FOLDER")->required();
  command->add_option("--board", options->board, "Board whose memories limit the network; default: ai_deck")
      ->type_name("BOARD")
      ->check(not_empty());
  command->add_option("--crop", options->crop, "First column and row of the part of larger pictures that is used")
      ->type_name("LEFT,TOP")
      ->check(not_empty());
  command
      ->add_option("--percentile", options->percentile,
                   "Percentage of a tensor's values within its range; default: all values")
      ->check(positive());
  command->add_flag("--equalise", options->equalise,
                    "Equalise the ranges of weights between layers, and print the accuracy with and without it");
  command
      ->add_option("--input-scale", options->input_scale,
                   "Increase of the network's input per grey level; default: 1/255")
      ->check(positive());
  command->add_option("--input-offset", options->input_offset, "Input of the network at grey level 0; default: 0");
  command->add_option("--pictures", options->pictures, "Largest number of pictures for the calibration; default: 256")
      ->check(CLI::PositiveNumber);
  command->add_option("--vectors", options->vectors, "Test vectors to write; default: 4")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--validate", options->validate,
                   "Pictures on which integers are compared with float; default: those of --data")
      ->type_name("PICTURES")
      ->check(not_empty());
  command
      ->add_option("--labels", options->labels,
                   "Labels of these pictures: columns picture, and class or names of outputs with one value")
      ->type_name("FILE.csv")
      ->check(not_empty());
  command
      ->add_option("--sizes", options->sizes,
                   "Smaller inputs to compare, such as 96x96,64x64 (columns x rows), or none; default: 3/4 and 1/2")
      ->type_name("SIZES")
      ->check(not_empty());
  command->add_flag("--no-measure", options->no_measure, "Check on this machine only, without the chip");
  command->add_flag("--json", options->json, "Print network.json in place of the table");
  command
      ->add_option("--page", options->page,
                   "Write a page for a browser into this file: layers, roofline, stalls, memory, energy")
      ->type_name("FILE.html")
      ->check(not_empty());
  command->footer(help_footer({"0 written", "1 a program failed, or integers differ", "2 the input cannot be used"},
                              {"mebots deploy dronet.onnx --data pictures --out dronet --page dronet.html",
                               "mebots deploy dronet.onnx --data himax --crop 62,44 --percentile 99.99 --out dronet"}));
  command->callback([options, &action] {
    action = [options] {
      return guarded([&] { become_python("mebots deploy", "mebots.deploy.command", words_of(*options)); });
    };
  });
}

}  // namespace mebots::app
