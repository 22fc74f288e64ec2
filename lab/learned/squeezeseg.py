"""SqueezeSeg (Wu, Wan, Yue, Keutzer: ICRA 2018) in PyTorch, and its file of weights.

Images are [batch, channel, row, column]: 5 channels, a row for each ring, 512 columns. Classes: clutter, thing, land.
"""

import hashlib
import json
import math

import numpy
import torch
from torch import nn
from torch.nn import functional

CLASSES = ("clutter", "thing", "land")
NUM_CHANNELS = 5
VIEW_COLUMNS = 512
NUM_VIEWS = 4

# The recurrent CRF, with the hyper-parameters that the authors' program has for cars: angles in pixels, positions in normalised coordinates.
CRF_STEPS = 3
CRF_ROWS = 3
CRF_COLUMNS = 5
CRF_THETA_ANGLE = 0.9
CRF_THETA_POSITION = 0.015
CRF_ANGLE_COEFFICIENT = 0.02
CRF_POSITION_COEFFICIENT = 0.1


class Deconvolution(nn.Module):
    """A transposed convolution of 1 x 4 with stride 2, which doubles the width: two convolutions, for even and odd columns, which PyTorch does faster.

    Weights are [input x output x 1 x 4]. Even columns: taps 3 and 1 on columns i - 1 and i; odd ones: taps 2 and 0 on columns i and i + 1.
    """

    def __init__(self, channels):
        super().__init__()
        self.weight = nn.Parameter(torch.zeros(channels, channels, 1, 4))
        self.bias = nn.Parameter(torch.zeros(channels))
        for channel in range(channels):
            self.weight.data[channel, channel, 0] = torch.tensor([0.25, 0.75, 0.75, 0.25])  # linear interpolation

    def forward(self, x):
        tap = self.weight.transpose(0, 1).unbind(3)
        none = torch.zeros_like(tap[0])
        even = torch.stack((tap[3], tap[1], none), 3)
        odd = torch.stack((none, tap[2], tap[0]), 3)
        y = functional.conv2d(x, torch.cat((even, odd)), self.bias.repeat(2), padding=(0, 1))
        batch, channels, rows, columns = y.shape
        y = y.view(batch, 2, channels // 2, rows, columns).permute(0, 2, 3, 4, 1)
        return y.reshape(batch, channels // 2, rows, 2 * columns).contiguous(memory_format=torch.channels_last)


class Dropout(nn.Module):
    """Half of the values, while training; from whole bytes of random numbers, which are quicker than one number for each value."""

    def forward(self, x):
        if not self.training:
            return x
        bytes_ = torch.randint(0, 256, (x.numel() // 8, 1), dtype=torch.uint8)
        kept = (bytes_.bitwise_and(2 ** torch.arange(8, dtype=torch.uint8)) != 0).view(x.shape[0], x.shape[2], x.shape[3], x.shape[1])
        return 2.0 * x * kept.permute(0, 3, 1, 2)


class Fire(nn.Module):
    """1x1 squeeze, optional deconvolution that doubles the width, then 1x1 and 3x3 expand side by side."""

    def __init__(self, inputs, squeezed, expanded, doubles_width=False):
        super().__init__()
        self.squeeze = nn.Conv2d(inputs, squeezed, 1)
        self.deconv = Deconvolution(squeezed) if doubles_width else None
        self.expand1 = nn.Conv2d(squeezed, expanded, 1)
        self.expand3 = nn.Conv2d(squeezed, expanded, 3, padding=1)

    def forward(self, x):
        x = functional.relu(self.squeeze(x))
        if self.deconv is not None:
            x = functional.relu(self.deconv(x))
        return torch.cat((functional.relu(self.expand1(x)), functional.relu(self.expand3(x))), 1)


class RecurrentCrf(nn.Module):
    """Three steps: messages of the 3 x 5 neighbours that hold a return, by two Gaussian kernels; compatibility; sum with the probabilities before.

    Only pixels with a return take part, and only these are computed: [pixel x class].
    """

    def __init__(self):
        super().__init__()
        others = torch.ones(len(CLASSES), len(CLASSES)) - torch.eye(len(CLASSES))
        self.angle_compatibility = nn.Parameter(CRF_ANGLE_COEFFICIENT * others)  # [class that is told x class that tells]
        self.position_compatibility = nn.Parameter(CRF_POSITION_COEFFICIENT * others)
        rows, columns = range(-(CRF_ROWS // 2), CRF_ROWS // 2 + 1), range(-(CRF_COLUMNS // 2), CRF_COLUMNS // 2 + 1)
        self.offsets = [(row, column) for row in rows for column in columns if (row, column) != (0, 0)]
        kernel = torch.tensor([math.exp(-(row**2 + column**2) / (2 * CRF_THETA_ANGLE**2)) for row, column in self.offsets])
        self.register_buffer("angle_kernel", kernel, persistent=False)

    def neighbours(self, mask):
        """@return for each pixel with a return the numbers of its neighbours among these pixels, [pixel x offset]; their count where there is none"""
        batch, rows, columns = mask.shape
        count = int(mask.sum())
        number = torch.full((batch, rows + CRF_ROWS - 1, columns + CRF_COLUMNS - 1), count)
        inside = number[:, CRF_ROWS // 2 : CRF_ROWS // 2 + rows, CRF_COLUMNS // 2 : CRF_COLUMNS // 2 + columns]
        inside[mask] = torch.arange(count)
        view, row, column = mask.nonzero(as_tuple=True)
        return torch.stack([number[view, row + CRF_ROWS // 2 + r, column + CRF_COLUMNS // 2 + c] for r, c in self.offsets], 1)

    def forward(self, logits, positions, mask):
        """logits: [pixel x class], positions: [pixel x 3], of the pixels that are set in mask [batch, row, column], in its order"""
        neighbours = self.neighbours(mask)
        with_none = lambda x: torch.cat((x, torch.zeros_like(x[:1])))
        distance2 = (with_none(positions)[neighbours] - positions.unsqueeze(1)).square().sum(2)
        position_kernel = self.angle_kernel * torch.exp(-distance2 / (2 * CRF_THETA_POSITION**2))
        for _ in range(CRF_STEPS):
            probability = functional.softmax(logits, 1)
            told = functional.embedding(neighbours, with_none(probability))
            by_angle = (told * self.angle_kernel.view(1, -1, 1)).sum(1)
            by_position = (told * position_kernel.unsqueeze(2)).sum(1)
            logits = probability + by_angle @ self.angle_compatibility.T + by_position @ self.position_compatibility.T
        return logits


class SqueezeSeg(nn.Module):
    """Widths of the paper; only the width of the image is halved. The mean and the deviation of each channel are of the training set."""

    def __init__(self):
        super().__init__()
        self.register_buffer("mean", torch.zeros(NUM_CHANNELS))
        self.register_buffer("deviation", torch.ones(NUM_CHANNELS))
        self.conv1 = nn.Conv2d(NUM_CHANNELS, 64, 3, stride=(1, 2), padding=1)
        self.conv1_skip = nn.Conv2d(NUM_CHANNELS, 64, 1)
        self.fire2 = Fire(64, 16, 64)
        self.fire3 = Fire(128, 16, 64)
        self.fire4 = Fire(128, 32, 128)
        self.fire5 = Fire(256, 32, 128)
        self.fire6 = Fire(256, 48, 192)
        self.fire7 = Fire(384, 48, 192)
        self.fire8 = Fire(384, 64, 256)
        self.fire9 = Fire(512, 64, 256)
        self.fire10 = Fire(512, 64, 128, doubles_width=True)
        self.fire11 = Fire(256, 32, 64, doubles_width=True)
        self.fire12 = Fire(128, 16, 32, doubles_width=True)
        self.fire13 = Fire(64, 16, 32, doubles_width=True)
        self.dropout = Dropout()
        self.conv14 = nn.Conv2d(64, len(CLASSES), 3, padding=1)
        self.crf = RecurrentCrf()
        self._initialise()
        self.to(memory_format=torch.channels_last)  # twice as fast on a processor

    def _initialise(self):
        # The authors began with the weights of SqueezeNet, trained on photographs; without them their small random numbers would let no signal through.
        for module in self.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, nonlinearity="relu")
                nn.init.zeros_(module.bias)
        nn.init.normal_(self.conv14.weight, std=0.05)

    def normalised(self, image):
        """Empty pixels are zeros before this, as in the authors' program."""
        return (image - self.mean.view(1, -1, 1, 1)) / self.deviation.view(1, -1, 1, 1)

    def unary(self, normalised):
        pool = lambda x: functional.max_pool2d(x, 3, stride=(1, 2), padding=1)
        conv1 = functional.relu(self.conv1(normalised))
        fire3 = self.fire3(self.fire2(pool(conv1)))
        fire5 = self.fire5(self.fire4(pool(fire3)))
        x = self.fire9(self.fire8(self.fire7(self.fire6(pool(fire5)))))
        x = self.fire10(x) + fire5
        x = self.fire11(x) + fire3
        x = self.fire12(x) + conv1
        # PyTorch 1.13 computes wrong gradients of the weights of these layers in 16 bits.
        with torch.autocast("cpu", enabled=False):
            x = self.fire13(x.float()) + functional.relu(self.conv1_skip(normalised))
            return self.conv14(self.dropout(x))

    def forward(self, image, mask):
        """@return log odds of the classes up to a constant, [pixel x class], of the pixels that are set in mask [batch, row, column], in its order; and
        those before the random field"""
        normalised = self.normalised(image)
        unary = self.unary(normalised.contiguous(memory_format=torch.channels_last))
        of_pixels = lambda x: x.permute(0, 2, 3, 1)[mask]
        with torch.autocast("cpu", enabled=False):
            unary = of_pixels(unary).float()
            return self.crf(unary, of_pixels(normalised[:, :3]), mask), unary


def save(model, path, about):
    """Writes path (NAME.json: what is known about the weights) and NAME.f16 beside it: all parameters as 16-bit floats, little endian, in the order of
    the layers, each its weight and then its bias; the compatibilities come last."""
    payload = b"".join(parameter.detach().numpy().astype("<f2").tobytes() for _, parameter in model.named_parameters())
    about = dict(about)
    about["parameters"] = len(payload) // 2
    about["mean"] = [float(value) for value in model.mean]
    about["deviation"] = [float(value) for value in model.deviation]
    about["weights_sha256"] = hashlib.sha256(payload).hexdigest()
    path.with_suffix(".f16").write_bytes(payload)
    path.write_text(json.dumps(about, indent=1) + "\n")


def load(path):
    about = json.loads(path.read_text())
    payload = numpy.frombuffer(path.with_suffix(".f16").read_bytes(), "<f2").astype(numpy.float32)
    model = SqueezeSeg()
    begin = 0
    for _, parameter in model.named_parameters():
        end = begin + parameter.numel()
        parameter.data = torch.from_numpy(payload[begin:end].copy()).view(parameter.shape)
        begin = end
    if begin != len(payload):
        raise ValueError(f"{path}: {len(payload)} weights, and the network has {begin}")
    model.mean = torch.tensor(about["mean"])
    model.deviation = torch.tensor(about["deviation"])
    return model.eval()
