"""Holds the probabilities of the C++ network (lookout-learned --weights) against those of PyTorch, on the same pixels.

compare.py SET WEIGHTS.json   prints the greatest difference, and of how many returns the likeliest class differs; fails above the tolerance
"""

import pathlib
import sys

import numpy
import torch

import scans
import squeezeseg

TOLERANCE = 1e-4


def main():
    folder, weights = (pathlib.Path(argument) for argument in sys.argv[1:])
    torch.set_num_threads(1)
    data = scans.ScanSet(folder)
    model = squeezeseg.load(weights)
    theirs = numpy.fromfile(folder / "probabilities.bin", "<f4").reshape(-1, len(squeezeseg.CLASSES))
    if len(theirs) != len(data.rows):
        raise SystemExit(f"{folder}: {len(theirs)} probabilities for {len(data.rows)} returns")
    greatest, num_others = 0.0, 0
    for view in range(len(data.views)):
        image, mask, _ = data.batch([view])
        with torch.no_grad():
            ours = torch.softmax(model(torch.from_numpy(image), torch.from_numpy(mask))[0], 1).numpy()
        rows = numpy.arange(data.begin[view], data.end[view])
        other = theirs[rows]  # by pixel, as the mask has them
        greatest = max(greatest, float(numpy.abs(ours - other).max()))
        num_others += int((ours.argmax(1) != other.argmax(1)).sum())
    print(f"{len(numpy.unique(data.scan_of_view))} scans, {len(data.rows)} returns: greatest difference {greatest:.2e}, another class {num_others}")
    if not greatest <= TOLERANCE:
        raise SystemExit(f"more than {TOLERANCE}")


if __name__ == "__main__":
    main()
