"""Trains the nail net and measures it on folds.

    python train.py --data DATA --phantoms DIR --runs DIR --fold 0      # and 1, 2: never sees the fold's photographs
    python train.py --data DATA --phantoms DIR --runs DIR --all         # all photographs: the shipped weights

Each run writes `RUNS/fold-K.pt` (or `all.pt`), the running mean of the weights, and a log beside it.
"""

import argparse
import os
import pathlib
import time

import cv2
import numpy as np
import torch
from torch.nn import functional as F

import data
from net import NailNet, imagenet_path, read_imagenet

BATCH = 16
SIZE = 192
TRUNK_RATE, DECODER_RATE = 6e-4, 3e-3
WARM = 0.08  # part of the steps over which the learning rates rise


def loss_of(logits, truth):
    """Binary cross-entropy and Dice of nail and core; both `n x 2 x h x w`."""
    entropy = F.binary_cross_entropy_with_logits(logits, truth)
    p = torch.sigmoid(logits)
    both = (p * truth).sum((0, 2, 3))
    dice = 1 - (2 * both + 1) / (p.sum((0, 2, 3)) + truth.sum((0, 2, 3)) + 1)
    return 4 * entropy + dice.mean()


def rate(step, steps):
    """Gain of the learning rates: up in a line, down as a cosine to 1 %."""
    if step < WARM * steps:
        return (step + 1) / (WARM * steps)
    part = (step - WARM * steps) / max(1, steps * (1 - WARM))
    return 0.01 + 0.99 * 0.5 * (1 + np.cos(np.pi * min(1, part)))


def freeze(net, count):
    """Holds the stem and the first `count` blocks at their ImageNet weights; the parameters that are left."""
    for layer in [net.stem, *list(net.blocks)[:count]] if count else []:
        for p in layer.parameters():
            p.requires_grad_(False)
    trunk = [p for p in net.trunk() if p.requires_grad]
    return [{"params": trunk, "lr": TRUNK_RATE}, {"params": net.decoder(), "lr": DECODER_RATE}]


def begun(start):
    """A net with ImageNet's trunk, or one that was trained already."""
    torch.manual_seed(1)
    net = NailNet()
    if start:
        net.load_state_dict(torch.load(start, map_location="cpu", weights_only=True))
    else:
        read_imagenet(net, imagenet_path())
    return net


def train(net, samples, steps, frozen, gain, device, path):
    """Trains a net, writes the running mean of its weights to `path` now and then and at the end."""
    net.to(device, memory_format=torch.channels_last)
    optimizer = torch.optim.AdamW(freeze(net, frozen), weight_decay=1e-4)
    peaks = [gain * g["lr"] for g in optimizer.param_groups]
    mean = {k: v.detach().clone() for k, v in net.state_dict().items()}
    started, total, log = time.time(), 0.0, open(path.with_suffix(".log"), "w")
    for step in range(steps):
        for group, peak in zip(optimizer.param_groups, peaks):
            group["lr"] = peak * rate(step, steps)
        rgb, truth = samples.batch(BATCH)
        x = torch.from_numpy(rgb).to(device).permute(0, 3, 1, 2).float().div(255)
        x = x.contiguous(memory_format=torch.channels_last)
        loss = loss_of(net(x), torch.from_numpy(truth).to(device).permute(0, 3, 1, 2))
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_([p for g in optimizer.param_groups for p in g["params"]], 5.0)
        optimizer.step()
        keep = min(0.99, step / (step + 10))
        with torch.no_grad():
            for k, v in net.state_dict().items():
                mean[k].lerp_(v, 1 - keep)
        total += float(loss)
        if step % 25 == 24 or step == steps - 1:
            print(f"step {step + 1}/{steps} loss {total / (step % 25 + 1):.4f} seconds {time.time() - started:.0f}",
                  file=log, flush=True)
            total = 0.0
        if step % 100 == 99 or step == steps - 1:
            torch.save({k: v.cpu().contiguous() for k, v in mean.items()}, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", default=os.environ.get("LUNULA_REAL_DATA"), help="folder of nail/vpapenko_cc0, ti1k")
    parser.add_argument("--phantoms", required=True, help="folder of folders that `lunula phantom photos` wrote")
    parser.add_argument("--runs", required=True, help="where checkpoints and logs go")
    parser.add_argument("--fold", type=int, help="leave these photographs out")
    parser.add_argument("--all", action="store_true", help="train on every photograph")
    parser.add_argument("--steps", type=int, default=12000, help="steps of 16 samples")
    parser.add_argument("--frozen", type=int, default=0, help="blocks held at their ImageNet weights, the stem too")
    parser.add_argument("--start", help="checkpoint to go on from instead of ImageNet's weights")
    parser.add_argument("--gain", type=float, default=1.0, help="of the learning rates")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--threads", type=int, default=1)
    args = parser.parse_args()
    if (args.fold is None) != args.all:
        parser.error("one of --fold and --all")
    torch.set_num_threads(args.threads)
    cv2.setNumThreads(1)
    root, runs = pathlib.Path(args.data), pathlib.Path(args.runs)
    runs.mkdir(parents=True, exist_ok=True)
    photos = [p for p in data.photographs(root) if p.fold != args.fold]
    ghosts = [g for folder in sorted(pathlib.Path(args.phantoms).iterdir()) for g in data.phantoms(folder)]
    samples = data.Samples(photos, ghosts, data.hand_free(root), SIZE, args.seed)
    name = "all" if args.all else f"fold-{args.fold}"
    device, path = torch.device(args.device), runs / f"{name}.pt"
    train(begun(args.start), samples, args.steps, args.frozen, args.gain, device, path)


if __name__ == "__main__":
    main()
