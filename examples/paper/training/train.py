# SPDX-License-Identifier: Apache-2.0
"""Trains the navigator in floating point, then with the integers of the chip."""

import argparse
import json
import pathlib
import time

import numpy as np
import torch
from torch.nn import functional

from data import Pictures, batches
from network import OUTPUT_STEP, IntegerNavigator, Navigator

SEED = 20251121
BATCH = 64


def answers(model, pictures, device, scale):
    model.eval()
    with torch.no_grad():
        parts = [(model(torch.from_numpy(x).to(device)) * scale).cpu().numpy() for x, _ in batches(pictures, 250)]
    return np.clip(np.concatenate(parts), -1.0, 1.0)


def metrics(yaw, pictures):
    """Returns the errors in units of the output, over all pictures, and over the pictures with a gate ahead."""
    error = np.abs(yaw - pictures.yaw)
    seen = pictures.visible & (pictures.strength == 1)
    return {"mean_error": float(error.mean()), "median_error_gate": float(np.median(error[seen])),
            "p95_error_gate": float(np.quantile(error[seen], 0.95)),
            "within_0.1": float((error < 0.1).mean()), "within_0.1_gate": float((error[seen] < 0.1).mean()),
            "mean_output_no_gate": float(np.abs(yaw[~pictures.visible]).mean()) if (~pictures.visible).any() else 0.0}


def fit(model, train, validation, epochs, rate, decay, scale, device, name, batch=BATCH):
    """Trains with Adam. The learning rate rises and falls once. Prints a line per epoch."""
    random = np.random.default_rng(SEED)
    optimizer = torch.optim.Adam(model.parameters(), lr=rate, weight_decay=decay)
    steps = epochs * -(-len(train) // batch)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, rate, total_steps=steps, pct_start=0.2)
    for epoch in range(epochs):
        model.train()
        start = time.monotonic()
        total = 0.0
        for pixels, yaw in batches(train, batch, random):
            output = model(torch.from_numpy(pixels).to(device)) * scale
            loss = functional.smooth_l1_loss(output, torch.from_numpy(yaw).to(device), beta=0.1)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            schedule.step()
            total += float(loss.detach()) * len(yaw)
        result = metrics(answers(model, validation, device, scale), validation)
        print(f"{name} {epoch + 1}/{epochs}: loss {total / len(train):.5f}, {time.monotonic() - start:.0f} s, "
              + ", ".join(f"{k} {v:.3f}" for k, v in result.items()), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=pathlib.Path, help="folder with train, val and test pictures")
    parser.add_argument("out", type=pathlib.Path, help="folder to write the trained network to")
    parser.add_argument("--epochs", type=int, default=16)
    parser.add_argument("--integer-epochs", type=int, default=4)
    parser.add_argument("--rate", type=float, default=3e-3, help="highest learning rate in floating point")
    parser.add_argument("--start", type=pathlib.Path, help="float.pt of another training, to go on from")
    arguments = parser.parse_args()
    torch.manual_seed(SEED)
    device = "cuda" if torch.cuda.is_available() else "cpu"
    train, validation = Pictures(arguments.data / "train"), Pictures(arguments.data / "val")
    arguments.out.mkdir(parents=True, exist_ok=True)

    navigator = Navigator().to(device)
    if arguments.start:
        navigator.load_state_dict(torch.load(arguments.start, map_location=device))
    fit(navigator, train, validation, arguments.epochs, arguments.rate, 1e-4, 1.0, device, "float")
    torch.save(navigator.state_dict(), arguments.out / "float.pt")
    integer = IntegerNavigator(navigator.cpu()).to(device)
    before = metrics(answers(integer, validation, device, OUTPUT_STEP), validation)
    print("integer, before fine-tuning:", before, flush=True)
    if arguments.integer_epochs:
        fit(integer, train, validation, arguments.integer_epochs, 3e-4, 0.0, OUTPUT_STEP, device, "integer")
    integer.cpu()
    torch.save(integer.state_dict(), arguments.out / "integer.pt")

    layers = integer.exported()
    np.savez(arguments.out / "integer.npz", **{f"{what}{i}": array for i, layer in enumerate(layers)
                                              for what, array in zip(("weights", "biases", "shifts"), layer)})
    report = {"pictures": {"train": len(train), "val": len(validation)}, "before_fine_tuning": before}
    for name in ("val", "test", "easy", "hard"):
        if (arguments.data / f"{name}.labels.csv").exists():
            pictures = Pictures(arguments.data / name)
            report[name] = {"float": metrics(answers(navigator.cpu(), pictures, "cpu", 1.0), pictures),
                            "integer": metrics(answers(integer, pictures, "cpu", OUTPUT_STEP), pictures)}
    (arguments.out / "metrics.json").write_text(json.dumps(report, indent=2) + "\n")
    print(json.dumps(report, indent=2))


if __name__ == "__main__":
    main()
