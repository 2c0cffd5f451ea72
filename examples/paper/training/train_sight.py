# SPDX-License-Identifier: Apache-2.0
"""Trains the sight network in floating point, then with the integers of the chip. With --begin, trains a trained network further,
with cluttered pictures.
"""

import argparse
import json
import pathlib
import time

import numpy as np
import torch
from torch.nn import functional

import integer_network
from network import OUTPUT_STEP, SIGHT, IntegerNavigator, Navigator
from sight import Sights, batches

SEED = 20261123
BATCH = 64
# The factor from the output `visible` to its logit. With this factor, an output of 0.5 is nearly certain.
LOGIT = 6.0
VISIBLE_WEIGHT = 0.08
# Replaces VISIBLE_WEIGHT in the training with clutter, where the main question is whether there is a gate.
CLUTTER_VISIBLE_WEIGHT = 0.15
# The training with clutter also uses this number of pictures of the first training, so that the network keeps its abilities.
KEPT = 10000


def loss_of(outputs, wanted, visible_weight):
    """Returns the loss: errors of position and size if there is a gate, and the error of the detection."""
    there = wanted[:, 3:]
    place = functional.smooth_l1_loss(outputs[:, :3] * there, wanted[:, :3] * there, beta=0.05)
    return place + visible_weight * functional.binary_cross_entropy_with_logits(LOGIT * outputs[:, 3:], there)


def answers(model, sights, scale):
    model.eval()
    with torch.no_grad():
        parts = [(model(torch.from_numpy(x)) * scale).numpy() for x, _ in batches(sights, 250)]
    return np.clip(np.concatenate(parts), -1.0, 1.0)


def metrics(outputs, sights):
    """Returns errors in units of the outputs if there is a gate, and the shares of missed and of false gates."""
    there = sights.visible
    error = np.abs(outputs - sights.wanted)[there]
    result = {"missed": float((outputs[there, 3] <= 0).mean()),
              "imagined": float((outputs[~there, 3] > 0).mean()) if (~there).any() else 0.0}
    for i, name in enumerate(("yaw", "rise", "size")):
        result[f"{name}_median"] = float(np.median(error[:, i]))
        result[f"{name}_p95"] = float(np.quantile(error[:, i], 0.95))
    return result


def fit(model, train, validation, epochs, rate, decay, scale, name, keep, visible_weight=VISIBLE_WEIGHT):
    """Trains with Adam. The learning rate rises and falls once. Prints a line and saves the weights after each epoch.
    """
    random = np.random.default_rng(SEED)
    optimizer = torch.optim.Adam(model.parameters(), lr=rate, weight_decay=decay)
    steps = epochs * -(-len(train) // BATCH)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, rate, total_steps=steps, pct_start=0.2)
    for epoch in range(epochs):
        model.train()
        start = time.process_time()
        total = 0.0
        for pixels, wanted in batches(train, BATCH, random):
            pixels = torch.from_numpy(pixels).contiguous(memory_format=torch.channels_last)
            loss = loss_of(model(pixels) * scale, torch.from_numpy(wanted), visible_weight)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            schedule.step()
            total += float(loss.detach()) * len(wanted)
        torch.save(model.state_dict(), keep)
        result = metrics(answers(model, validation, scale), validation)
        print(f"{name} {epoch + 1}/{epochs}: loss {total / len(train):.5f}, {time.process_time() - start:.0f} s, "
              + ", ".join(f"{k} {v:.3f}" for k, v in result.items()), flush=True)


def save(integer, path):
    np.savez(path, **{f"{what}{i}": array for i, layer in enumerate(integer.exported())
                      for what, array in zip(("weights", "biases", "shifts"), layer)})


def read(weights):
    """Reads a weights file. Returns the network."""
    integer = IntegerNavigator(Navigator(SIGHT))
    shapes = [layer[0].shape for layer in integer.exported()]
    integer.take(integer_network.from_bytes(weights.read_bytes(), shapes))
    return integer


def train_among_clutter(arguments):
    """Continues the training of the network in a weights file with clutter_train and the first pictures of train. Evaluates the
    network on clutter_val and clutter_test."""
    integer = read(arguments.begin)
    data = {name: Sights(arguments.data / name) for name in ("train", "clutter_train", "clutter_val", "clutter_test")}
    print("before:", metrics(answers(integer, data["clutter_val"], OUTPUT_STEP), data["clutter_val"]), flush=True)
    fit(integer, data["clutter_train"].with_first(KEPT, data["train"]), data["clutter_val"], arguments.clutter_epochs,
        arguments.clutter_rate, 0.0, OUTPUT_STEP, "clutter", arguments.out / "clutter.pt", CLUTTER_VISIBLE_WEIGHT)
    save(integer, arguments.out / "integer.npz")
    print("after:", metrics(answers(integer, data["clutter_test"], OUTPUT_STEP), data["clutter_test"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=pathlib.Path, help="folder with the pictures: train, val; test, easy, hard")
    parser.add_argument("out", type=pathlib.Path, help="folder to write the trained network to")
    parser.add_argument("--epochs", type=int, default=13)
    parser.add_argument("--integer-epochs", type=int, default=2)
    parser.add_argument("--rate", type=float, default=4e-3, help="highest learning rate in floating point")
    parser.add_argument("--begin", type=pathlib.Path,
                        help="weights file to continue with in rooms with clutter, instead of a new network")
    parser.add_argument("--clutter-epochs", type=int, default=4)
    parser.add_argument("--clutter-rate", type=float, default=8e-4, help="highest learning rate with clutter")
    arguments = parser.parse_args()
    torch.manual_seed(SEED)
    torch.set_num_threads(1)  # one thread, so that sums have the same order on any machine
    arguments.out.mkdir(parents=True, exist_ok=True)
    if arguments.begin:
        train_among_clutter(arguments)
        return
    train, validation = Sights(arguments.data / "train"), Sights(arguments.data / "val")

    network = Navigator(SIGHT).to(memory_format=torch.channels_last)
    fit(network, train, validation, arguments.epochs, arguments.rate, 1e-5, 1.0, "float", arguments.out / "float.pt")
    network.eval()
    integer = IntegerNavigator(network)
    print("integer, before fine-tuning:", metrics(answers(integer, validation, OUTPUT_STEP), validation), flush=True)
    if arguments.integer_epochs:
        fit(integer, train, validation, arguments.integer_epochs, 3e-4, 0.0, OUTPUT_STEP, "integer",
            arguments.out / "integer.pt")
    save(integer, arguments.out / "integer.npz")
    report = {"pictures": {"train": len(train), "val": len(validation)}}
    for name in ("val", "test", "easy", "hard"):
        sights = Sights(arguments.data / name)
        report[name] = {"float": metrics(answers(network, sights, 1.0), sights),
                        "integer": metrics(answers(integer, sights, OUTPUT_STEP), sights)}
    (arguments.out / "metrics.json").write_text(json.dumps(report, indent=2) + "\n")
    print(json.dumps(report, indent=2))


if __name__ == "__main__":
    main()
