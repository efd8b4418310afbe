"""Writes the trained net for OpenCV's dnn, with a golden answer beside it.

    python export.py CHECKPOINT OUT_FOLDER
    python export.py PACKED.f16 OUT_FOLDER

The second writes a packed net again as this program does it now.

`nail-net.f16`: an ONNX file (opset 10: Clip with its limits as attributes; RGB in 0..1, probabilities out) with its f32
weights packed as f16, since OpenCV 4.6 reads no f16 weights; `packed` says how. The graph declares 64x96 pixels, but
OpenCV runs it on any multiple of 32.
`nail-net-golden.txt`, `nail-net-golden-finger.txt`: onnxruntime's answers, on the same weights, to pictures that
formulas make: stripes (nothing to find) and a finger.
"""

import argparse
import pathlib
import struct

import numpy as np
import onnx
import onnxruntime
import torch
from onnx import helper, numpy_helper

from net import NailNet

GOLDEN_SIZE = (64, 96)  # height, width
NARROW_FROM = 241  # channels; those of so many are at stride 16, where a second look is 10 pixels wide
APPENDED = 8  # columns that make 18 of them


class Probabilities(torch.nn.Module):
    """The net with a sigmoid at its end."""

    def __init__(self, net):
        super().__init__()
        self.net = net

    def forward(self, x):
        return torch.sigmoid(self.net(x))


def graph(net):
    """The net as an ONNX model with f32 weights."""
    path = pathlib.Path(torch.hub.get_dir()).parent / "nail-net-f32.onnx"
    path.parent.mkdir(parents=True, exist_ok=True)
    torch.onnx.export(Probabilities(net).eval(), torch.zeros(1, 3, *GOLDEN_SIZE), str(path), opset_version=10,
                      input_names=["rgb"], output_names=["probability"])
    model = onnx.load(str(path))
    path.unlink()
    model.producer_name, model.producer_version, model.doc_string = "lunula nail-net", "", ""
    for node in model.graph.node:
        node.doc_string = ""
    return model


def split(model):
    """The model with each depthwise convolution at stride 1 as OpenCV 4.6 does it fast: of 3x3, on 18 columns and more.

    240 channels of 64x48, one thread: 21 billion operations a second, of 5x5 1.7. So 5x5 is the sum of four of 3x3, one
    for each corner; and what may be narrower has columns appended and cut off again. With both the net takes 0.71, 0.73
    and 0.85 of the time at 256x192, 512x384 and 1024x768, 0.76 at the 160x160 of a second look.
    """
    weights = {tensor.name: tensor for tensor in model.graph.initializer}
    limits = [("s", 0), ("e", -APPENDED), ("a", 3)]
    model.graph.initializer.extend(numpy_helper.from_array(np.array([n]), name) for name, n in limits)
    nodes = []
    for node in model.graph.node:
        of = {a.name: helper.get_attribute_value(a) for a in node.attribute}
        channels = of.get("group", 1)
        is_wide, appended = of.get("kernel_shape") == [5, 5], APPENDED if channels >= NARROW_FROM else 0
        if channels == 1 or of.get("strides", [1, 1]) != [1, 1] or not (is_wide or appended):
            nodes.append(node)
            continue
        # Names are short, for the file's sake.
        name = f"{len(nodes)}"
        output = f"n{name}" if appended else node.output[0]
        if is_wide:
            whole = numpy_helper.to_array(weights[node.input[1]])
            parts = []
            for corner, (top, left) in enumerate(((0, 0), (0, 2), (2, 0), (2, 2))):
                part = whole[:, :, top:top + 3, left:left + 3].copy()
                # The middle row and column count once.
                part[:, :, :top // 2] = 0
                part[:, :, :, :left // 2] = 0
                of_part = f"{name}.{corner}"
                model.graph.initializer.append(numpy_helper.from_array(part, f"w{of_part}"))
                # One of them has the bias.
                inputs = [node.input[0], f"w{of_part}", *(node.input[2:] if not parts else [])]
                parts.append(f"y{of_part}")
                pads = [2 - top, 2 - left, top, left + appended]
                nodes.append(helper.make_node("Conv", inputs, [parts[-1]], name=of_part, group=channels,
                                              kernel_shape=[3, 3], pads=pads))
            model.graph.initializer.remove(weights[node.input[1]])
            nodes.append(helper.make_node("Sum", parts, [output], name=name))
        else:
            *pads, right = of["pads"]
            nodes.append(helper.make_node("Conv", node.input, [output], name=name, group=channels, kernel_shape=[3, 3],
                                          pads=[*pads, right + appended]))
        if appended:
            nodes.append(helper.make_node("Slice", [output, "s", "e", "a"], [node.output[0]], name=output))
    del model.graph.node[:]
    model.graph.node.extend(nodes)
    return model


def rounded(model):
    """The model with each f32 weight and bias rounded to the nearest f16, still stored as f32."""
    for tensor in model.graph.initializer:
        value = numpy_helper.to_array(tensor)
        if value.dtype == np.float32:
            near = value.astype(np.float16).astype(np.float32)
            tensor.CopyFrom(numpy_helper.from_array(near, tensor.name))
    return model


def packed(model):
    """The bytes of an ONNX model with its f32 weights as f16.

    Chunks up to the end of the file: u32 n, n bytes as they are, u32 m, m f16 values that stand for m f32 values;
    all little-endian. The bytes and the widened values, one after the other, are the ONNX file.
    """
    whole = model.SerializeToString()
    chunks, at = [], 0
    for tensor in model.graph.initializer:
        if tensor.data_type != onnx.TensorProto.FLOAT:
            continue
        start = whole.index(tensor.raw_data, at)
        values = np.frombuffer(tensor.raw_data, "<f4").astype("<f2")
        chunks += [struct.pack("<I", start - at), whole[at:start], struct.pack("<I", values.size), values.tobytes()]
        at = start + len(tensor.raw_data)
    chunks += [struct.pack("<I", len(whole) - at), whole[at:], struct.pack("<I", 0)]
    return b"".join(chunks)


def unpacked(data):
    """The ONNX file of `packed`'s bytes: the model of a reader in any language."""
    out, at = [], 0
    while at < len(data):
        (n,) = struct.unpack_from("<I", data, at)
        out.append(data[at + 4:at + 4 + n])
        at += 4 + n
        (m,) = struct.unpack_from("<I", data, at)
        out.append(np.frombuffer(data, "<f2", m, at + 4).astype("<f4").tobytes())
        at += 4 + 2 * m
    return b"".join(out)


def stripes(height, width):
    """`1 x 3 x height x width`: ((7 x + 13 y + 29 c) mod 256) / 255 with c = 0 for red."""
    c, y, x = np.mgrid[0:3, 0:height, 0:width]
    return (((7 * x + 13 * y + 29 * c) % 256) / 255).astype(np.float32)[None]


def finger(height, width):
    """A finger that points up, shaded, with a nail, before slate (FINGER has the formula)."""
    y, x = np.mgrid[0:height, 0:width].astype(np.float64)
    d = (x - 48) ** 2 + np.minimum(y - 28, 0) ** 2
    skin, nail = d < 400, ((x - 48) / 14) ** 2 + ((y - 27.5) / 17.5) ** 2 < 1
    rgb = np.empty((3, height, width))
    for c, (ground, flesh, plate) in enumerate(zip((51, 64, 77), (204, 153, 128), (230, 170, 165))):
        rgb[c] = np.where(nail, plate * (1 - ((x - 48) / 28) ** 2), np.where(skin, flesh * (1 - d / 800), ground))
    return (rgb[None] / 255).astype(np.float32)


def golden(model, picture, words):
    """Lines `channel y x probability` of onnxruntime's answer to a picture."""
    session = onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])
    answer = session.run(None, {"rgb": picture(*GOLDEN_SIZE)})[0][0]
    lines = [
        f"# onnxruntime's answer to 1 x 3 x {GOLDEN_SIZE[0]} x {GOLDEN_SIZE[1]}, channels red, green, blue:",
        *(f"# {line}" for line in words),
        "# channel (0 nail, 1 core), y, x, probability; then the mean of each channel as y = x = -1",
    ]
    for channel in range(2):
        for y in range(3, answer.shape[1], 7):
            for x in range(2, answer.shape[2], 11):
                lines.append(f"{channel} {y} {x} {answer[channel, y, x]:.6g}")
        lines.append(f"{channel} -1 -1 {answer[channel].mean():.6g}")
    return "\n".join(lines) + "\n"


STRIPES = ["((7 x + 13 y + 29 c) mod 256) / 255, c = 0 for red, 1 for green, 2 for blue"]
FINGER = [
    "(230, 170, 165) / 255 * (1 - ((x - 48) / 28)^2) where ((x - 48) / 14)^2 + ((y - 27.5) / 17.5)^2 < 1,",
    "else (204, 153, 128) / 255 * (1 - d / 800) where d = (x - 48)^2 + min(y - 28, 0)^2 < 400,",
    "else (51, 64, 77) / 255",
]


def write(model, folder):
    """The three files into `folder`."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    model = rounded(model)
    # Of the net as it was trained: they check the split as well.
    (folder / "nail-net-golden.txt").write_text(golden(model, stripes, STRIPES))
    (folder / "nail-net-golden-finger.txt").write_text(golden(model, finger, FINGER))
    model = split(model)
    data = packed(model)
    if unpacked(data) != model.SerializeToString():
        raise ValueError("the packed net does not unpack to the same bytes")
    (folder / "nail-net.f16").write_bytes(data)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkpoint")
    parser.add_argument("folder")
    args = parser.parse_args()
    if args.checkpoint.endswith(".f16"):
        model = onnx.load_from_string(unpacked(pathlib.Path(args.checkpoint).read_bytes()))
    else:
        net = NailNet()
        net.load_state_dict(torch.load(args.checkpoint, map_location="cpu", weights_only=True))
        model = graph(net)
    write(model, args.folder)


if __name__ == "__main__":
    main()
