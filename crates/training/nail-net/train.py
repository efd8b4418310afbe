"""Trains nail nets and lets each see all photographs but a fold.

    python train.py --data DATA --phantoms DIR --runs DIR --nets 0 1 2 all

Net 0, 1 or 2 never sees that fold's photographs; `all`, whose weights are shipped, sees every one. They learn from one
stream of samples. Each writes `RUNS/fold-K.pt` (or `all.pt`), the running mean of its weights, and a log beside it.
"""

import argparse
import os
import pathlib
import time

import cv2
import numpy as np
import torch
from torch.nn import functional as F
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

import data
from net import NailNet, imagenet_path, read_imagenet

SIZE = 192
CHUNK = 16  # samples that a process makes at once
TRUNK_RATE, DECODER_RATE = 6e-4, 3e-3  # for batches of 16
WARM = 0.08  # part of the steps over which the learning rates rise


class Stream(IterableDataset):
    """Endless chunks of samples; the seed and the number of processes say which ones."""

    def __init__(self, seed, *sources):
        self.seed, self.sources = seed, sources

    def __iter__(self):
        worker = get_worker_info()
        samples = data.Samples(*self.sources, SIZE, [self.seed, worker.id if worker else 0])
        while True:
            yield samples.batch(CHUNK)


def loss_of(logits, truth):
    """Binary cross-entropy and Dice of nail and core; both `n x 2 x h x w`."""
    entropy = F.binary_cross_entropy_with_logits(logits, truth)
    p = torch.sigmoid(logits)
    both = (p * truth).sum((0, 2, 3))
    dice = 1 - (2 * both + 1) / (p.sum((0, 2, 3)) + truth.sum((0, 2, 3)) + 1)
    return 4 * entropy + dice.mean()


def rate(part):
    """Gain of the learning rates, by the part of the training that is done: up in a line, down as a cosine to 1 %."""
    if part < WARM:
        return (part + 0.002) / (WARM + 0.002)
    return 0.01 + 0.99 * 0.5 * (1 + np.cos(np.pi * min(1, (part - WARM) / (1 - WARM))))


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


class Student:
    """A net in training."""

    def __init__(self, name, args, runs):
        self.fold = -1 if name == "all" else int(name)
        self.path = runs / f"{'all' if name == 'all' else 'fold-' + name}.pt"
        self.net = begun(args.start).to(args.device, memory_format=torch.channels_last)
        self.optimizer = torch.optim.AdamW(freeze(self.net, args.frozen), weight_decay=1e-4)
        gain = args.gain * (args.batch / 16) ** 0.5
        self.peaks = [gain * group["lr"] for group in self.optimizer.param_groups]
        self.mean = [p.detach().clone() for p in self.net.parameters()]
        self.batch, self.waiting, self.steps, self.losses = args.batch, [], 0, []
        self.log = open(self.path.with_suffix(".log"), "w")

    def take(self, rgb, truth, folds, part):
        """Learns from the samples of the other folds, a full batch at a time."""
        chosen = (folds != self.fold) | (folds < 0)
        self.waiting.append((rgb[chosen], truth[chosen]))
        rgb, truth = (torch.cat(parts) for parts in zip(*self.waiting))
        while len(rgb) >= self.batch:
            self.step(rgb[:self.batch], truth[:self.batch], part)
            rgb, truth = rgb[self.batch:], truth[self.batch:]
        self.waiting = [(rgb, truth)]

    def step(self, rgb, truth, part):
        """One step; `rgb` and `truth` are u8 with the channels last."""
        for group, peak in zip(self.optimizer.param_groups, self.peaks):
            group["lr"] = peak * rate(part)
        x, y = (a.permute(0, 3, 1, 2).float().div(255) for a in (rgb, truth))
        with torch.autocast(x.device.type, torch.bfloat16, enabled=x.is_cuda):
            logits = self.net(x.contiguous(memory_format=torch.channels_last))
        loss = loss_of(logits.float(), y)
        self.optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_([p for g in self.optimizer.param_groups for p in g["params"]], 5.0)
        self.optimizer.step()
        with torch.no_grad():
            torch._foreach_lerp_(self.mean, list(self.net.parameters()), 1 - min(0.99, self.steps / (self.steps + 10)))
        self.steps += 1
        self.losses.append(loss.detach())

    def report(self, seconds):
        """A line of the log, and the checkpoint."""
        if not self.losses:
            return
        loss, self.losses = float(torch.stack(self.losses).mean()), []
        print(f"step {self.steps} loss {loss:.4f} seconds {seconds:.0f}", file=self.log, flush=True)
        names = [name for name, _ in self.net.named_parameters()]
        torch.save({k: v.cpu().contiguous() for k, v in zip(names, self.mean)}, self.path)


def train(students, stream, args):
    """Until `all` had its steps, or the minutes are over (the learning rates fall by what comes first)."""
    ahead = 4 if args.workers else None
    chunks = iter(DataLoader(stream, batch_size=None, num_workers=args.workers, prefetch_factor=ahead))
    started, count = time.time(), 0
    while True:
        rgb, truth, folds = (torch.as_tensor(a).to(args.device) for a in next(chunks))
        done = max((time.time() - started) / (60 * args.minutes), count * CHUNK / (args.steps * args.batch))
        for student in students:
            student.take(rgb, truth, folds, done)
        count += 1
        if count % 200 == 0 or done >= 1:
            for student in students:
                student.report(time.time() - started)
        if done >= 1:
            return


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", default=os.environ.get("LUNULA_REAL_DATA"), help="folder of nail/vpapenko_cc0, ti1k")
    parser.add_argument("--phantoms", required=True, help="folder of folders that `lunula phantom photos` wrote")
    parser.add_argument("--runs", required=True, help="where checkpoints and logs go")
    parser.add_argument("--nets", nargs="+", required=True, choices=["0", "1", "2", "all"])
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--steps", type=int, default=12000, help="batches that are made; a fold's net skips its fold")
    parser.add_argument("--minutes", type=float, default=1e9, help="end here, if the steps are not done by then")
    parser.add_argument("--frozen", type=int, default=0, help="blocks held at their ImageNet weights, the stem too")
    parser.add_argument("--start", help="checkpoint to go on from instead of ImageNet's weights")
    parser.add_argument("--gain", type=float, default=1.0, help="of the learning rates")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--workers", type=int, default=0, help="processes that make samples")
    args = parser.parse_args()
    torch.set_num_threads(args.threads)
    cv2.setNumThreads(1)  # its threads would not live on in the processes that make samples
    root, runs = pathlib.Path(args.data), pathlib.Path(args.runs)
    runs.mkdir(parents=True, exist_ok=True)
    photos = data.photographs(root)
    ghosts = [g for folder in sorted(pathlib.Path(args.phantoms).iterdir()) for g in data.phantoms(folder)]
    stream = Stream(args.seed, photos, ghosts, data.hand_free(root))
    train([Student(name, args, runs) for name in args.nets], stream, args)


if __name__ == "__main__":
    main()
