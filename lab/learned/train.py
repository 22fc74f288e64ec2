"""Trains SqueezeSeg on a set of lookout-learned. train.sh has the commands.

The same line gives the same weights on one machine: one thread, one generator of random numbers, a fixed number of steps.
"""

import argparse
import csv
import math
import pathlib
import sys
import time

import numpy
import torch
from torch.nn import functional

import scans
import squeezeseg

# Seeds of the set: the last ones only draw the curve. Nothing is chosen by it.
LAST_SEED = 90
LAST_CURVE_SEED = 100

# The authors' values, but for the rate (theirs: 0.01), the batch (theirs: 32) and the schedule (theirs: half the rate every 10 000 steps; here one descent
# to 0).
LEARNING_RATE = 0.02
MOMENTUM = 0.9
WEIGHT_DECAY = 1e-4
LOSS_COEFFICIENT = 15.0
MAX_GRADIENT_NORM = 1.0  # of each array of weights
WARM_UP_STEPS = 50


def class_weights(labels):
    """By the square root of how rare a class is: rarer ones weigh more, and the mean weight of a return is 1."""
    share = numpy.bincount(labels, minlength=len(squeezeseg.CLASSES)) / len(labels)
    weight = 1.0 / numpy.sqrt(numpy.maximum(share, 1e-4))
    return torch.tensor(weight / (share * weight).sum(), dtype=torch.float32)


def rate_at(step, num_steps):
    warm_up = min(1.0, (step + 1) / WARM_UP_STEPS)
    return LEARNING_RATE * warm_up * 0.5 * (1.0 + math.cos(math.pi * step / num_steps))


def loss_of(model, image, mask, label, weight):
    # The convolutions in 16 bits (bfloat16) take half the time; weights and sums stay in 32 bits.
    with torch.autocast("cpu", torch.bfloat16):
        refined, unary = model(image, mask)
    # Behind three softmaxes the gradient is some thirtieth: without the second term the network learns as much slower. The authors trained longer.
    cross_entropy = lambda log_odds: functional.cross_entropy(log_odds, label[mask], weight=weight, reduction="none").mean()
    return LOSS_COEFFICIENT * (cross_entropy(refined) + cross_entropy(unary))


def ious(model, data, views, batch_size):
    """IoU of each class over the returns of these views."""
    model.eval()
    confusion = numpy.zeros((len(squeezeseg.CLASSES),) * 2, numpy.int64)
    with torch.no_grad():
        for first in range(0, len(views), batch_size):
            image, mask, label = data.batch(views[first : first + batch_size])
            found = model(torch.from_numpy(image), torch.from_numpy(mask))[0].argmax(1).numpy()
            numpy.add.at(confusion, (label[mask], found), 1)
    model.train()
    union = confusion.sum(0) + confusion.sum(1) - confusion.diagonal()
    return confusion.diagonal() / numpy.maximum(union, 1)


def train(data, families, options, log):
    torch.set_num_threads(1)
    torch.use_deterministic_algorithms(True)
    torch.manual_seed(options.seed)
    random = numpy.random.RandomState(options.seed)

    views = data.views_of(families, 1, LAST_SEED)
    curve_views = data.views_of(families, LAST_SEED + 1, LAST_CURVE_SEED)
    curve_views = numpy.sort(random.permutation(curve_views)[: options.curve_views])
    rows = data.rows[data.rows_of(views)]
    model = squeezeseg.SqueezeSeg()
    model.mean = torch.from_numpy(rows["channels"].mean(0, dtype=numpy.float64).astype(numpy.float32))
    model.deviation = torch.from_numpy(rows["channels"].std(0, dtype=numpy.float64).astype(numpy.float32))
    weight = class_weights(rows["label"])
    print(f"{len(families)} families, {len(numpy.unique(data.scan_of_view[views]))} scans, {len(views)} views, {len(rows)} returns; weights of classes "
          f"{[round(float(w), 3) for w in weight]}", file=sys.stderr)
    optimiser = torch.optim.SGD(model.parameters(), lr=LEARNING_RATE, momentum=MOMENTUM, weight_decay=WEIGHT_DECAY)

    order = numpy.zeros(0, numpy.int64)
    losses = []
    begin_s = time.monotonic()
    for step in range(options.steps):
        if len(order) < options.batch:
            order = numpy.concatenate((order, random.permutation(views)))
        batch, order = order[: options.batch], order[options.batch :]
        image, mask, label = (torch.from_numpy(array) for array in data.batch(batch, random.rand(options.batch) < 0.5))
        for group in optimiser.param_groups:
            group["lr"] = rate_at(step, options.steps)
        optimiser.zero_grad()
        loss = loss_of(model, image, mask, label, weight)
        loss.backward()
        for parameter in model.parameters():
            torch.nn.utils.clip_grad_norm_([parameter], MAX_GRADIENT_NORM)
        optimiser.step()
        losses.append(loss.item())
        if (step + 1) % options.curve_every == 0 or step + 1 == options.steps:
            iou = ious(model, data, curve_views, options.batch) if len(curve_views) else [math.nan] * len(squeezeseg.CLASSES)
            log.writerow([step + 1, f"{numpy.mean(losses):.4f}", *(f"{100 * value:.1f}" for value in iou)])
            print(f"step {step + 1}, {time.monotonic() - begin_s:.0f} s, loss {numpy.mean(losses):.4f}, IoU {[round(100 * float(v), 1) for v in iou]}",
                  file=sys.stderr, flush=True)
            losses = []
    return model, len(views)


def main():
    parser = argparse.ArgumentParser(description="Trains SqueezeSeg on labelled pixels of simulated scans.")
    parser.add_argument("--set", type=pathlib.Path, required=True, help="folder that lookout-learned wrote")
    parser.add_argument("--without", default="", help="families that are not trained on, separated by commas")
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--batch", type=int, default=16, help="views of a step")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--curve-every", type=int, default=50, help="steps between two points of the curve")
    parser.add_argument("--curve-views", type=int, default=96, help="views of the curve, at most")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="NAME.json; NAME.f16 and NAME.csv (the curve) are written beside it")
    options = parser.parse_args()

    data = scans.ScanSet(options.set)
    without = [name for name in options.without.split(",") if name]
    unknown = set(without) - set(data.family)
    if unknown:
        parser.error(f"--without: not in the set: {', '.join(sorted(unknown))}")
    families = sorted(set(data.family) - set(without))
    with open(options.out.with_suffix(".csv"), "w", newline="") as file:
        log = csv.writer(file, lineterminator="\n")
        log.writerow(["step", "loss", *(f"iou_{name}_%" for name in squeezeseg.CLASSES)])
        model, num_views = train(data, families, options, log)
    squeezeseg.save(model, options.out, {
        "network": "SqueezeSeg",
        "classes": squeezeseg.CLASSES,
        "trained_on": families,
        "training_seeds": [1, LAST_SEED],
        "views": num_views,
        "set_sha256": scans.digest(options.set),
        "command": f"train.py --set SET{' --without ' + options.without if without else ''} --steps {options.steps} --batch {options.batch} "
                   f"--seed {options.seed} --out {options.out.name}",
    })


if __name__ == "__main__":
    main()
