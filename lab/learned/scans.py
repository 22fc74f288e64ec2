"""The set that lookout-learned writes: labelled pixels of simulated scans, as images of views."""

import csv
import hashlib

import numpy

from squeezeseg import NUM_CHANNELS, NUM_VIEWS, VIEW_COLUMNS

ROW = numpy.dtype([("scan", "<i4"), ("pixel", "<i4"), ("channels", "<f4", NUM_CHANNELS), ("label", "<i4")])


class ScanSet:
    """All scans of a folder; all have the same number of rings."""

    def __init__(self, folder):
        with open(folder / "scans.csv", newline="") as file:
            scans = list(csv.DictReader(file))
        self.family = numpy.array([scan["family"] for scan in scans])
        self.seed = numpy.array([int(scan["seed"]) for scan in scans])
        rings = {int(scan["rings"]) for scan in scans}
        if len(rings) != 1:
            raise ValueError(f"{folder}: scans of {sorted(rings)} rings in one set")
        self.num_rows = rings.pop()
        self.rows = numpy.fromfile(folder / "returns.bin", ROW)
        view = self.rows["scan"].astype(numpy.int64) * NUM_VIEWS + self.rows["pixel"] // (self.num_rows * VIEW_COLUMNS)
        if numpy.any(numpy.diff(view) < 0):
            raise ValueError(f"{folder}: returns are out of order")
        # Of the views that hold a return: which rows are theirs, and which scan they are of.
        self.views, self.begin = numpy.unique(view, return_index=True)
        self.end = numpy.append(self.begin[1:], len(self.rows))
        self.scan_of_view = self.views // NUM_VIEWS

    def views_of(self, families, first_seed, last_seed):
        family = self.family[self.scan_of_view]
        seed = self.seed[self.scan_of_view]
        return numpy.flatnonzero(numpy.isin(family, list(families)) & (seed >= first_seed) & (seed <= last_seed))

    def rows_of(self, views):
        return numpy.concatenate([numpy.arange(self.begin[view], self.end[view]) for view in views])

    def batch(self, views, flipped=None):
        """@return image [view, channel, row, column], mask [view, row, column], label [view, row, column]; flipped: for each view, left for right"""
        shape = (len(views), self.num_rows, VIEW_COLUMNS)
        image = numpy.zeros((len(views), NUM_CHANNELS, self.num_rows, VIEW_COLUMNS), numpy.float32)
        mask = numpy.zeros(shape, bool)
        label = numpy.zeros(shape, numpy.int64)
        for i, view in enumerate(views):
            rows = self.rows[self.begin[view] : self.end[view]]
            pixel = rows["pixel"] % (self.num_rows * VIEW_COLUMNS)
            row, column = pixel // VIEW_COLUMNS, pixel % VIEW_COLUMNS
            channels = rows["channels"].copy()
            if flipped is not None and flipped[i]:
                column = VIEW_COLUMNS - 1 - column
                channels[:, 1] = -channels[:, 1]
            image[i][:, row, column] = channels.T
            mask[i, row, column] = True
            label[i, row, column] = rows["label"]
        return image, mask, label


def digest(folder):
    """SHA-256 of both files, one behind the other."""
    sha256 = hashlib.sha256()
    for name in ("scans.csv", "returns.bin"):
        sha256.update((folder / name).read_bytes())
    return sha256.hexdigest()
