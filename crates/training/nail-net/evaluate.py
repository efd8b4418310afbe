"""Measures the folds' nets on the photographs that they never saw, and calibrates the confidence on them.

    python evaluate.py gather --data DATA --phantoms OTHER_DIR --runs RUNS --name fold-0     # and fold-1, fold-2, all
    python evaluate.py figures --runs RUNS --out DIR

`gather` runs a net over its held-out photographs (for `all` there are none), phantoms of another seed and hand-free
pictures, and keeps every find. `figures` fits the confidence by logistic regression and writes
`finds.csv`, `calibration.txt` and `figures.md`: figures of a fold use coefficients fitted on the other folds.
"""

import argparse
import csv
import os
import pathlib
import pickle

import cv2
import numpy as np
import torch

import data
import drawn
import find
from net import NailNet

VARIANTS = ["colour", "dark", "dark-even", "grey", "green", "far"]
FITTED = ["colour", "dark", "dark-even", "grey", "green"]  # variants that the confidence is fitted on
WAYS = {"usual": dict(), "without 1024": dict(far=False), "always 1024": dict(sides=(*find.SIDES, 1024), far=False),
        "256, 512": dict(sides=(256, 512), far=False)}  # ways to look, compared
NEGATIVE_SEED = 9000
FAR = 0.35  # of its size is a photograph shrunk to, in the variant "far"


def forward_of(path):
    """A checkpoint as a function from `1 x 3 x h x w` to probabilities `2 x h/2 x w/2`."""
    net = NailNet()
    net.load_state_dict(torch.load(path, map_location="cpu", weights_only=True))
    net.eval().to(memory_format=torch.channels_last)

    def forward(x):
        with torch.inference_mode():
            return torch.sigmoid(net(torch.from_numpy(np.ascontiguousarray(x))))[0].numpy()
    return forward


def varied(picture, variant):
    """A photograph (u8 RGB) and its nail mask as one of VARIANTS."""
    rgb, nail = picture.rgb, picture.nail
    if variant.startswith("dark"):
        kept = 1.0 if variant == "dark-even" else 0.6
        rgb = data.darkened(rgb, np.maximum(picture.hand, nail), nail, 1.0, kept)
    elif variant == "grey":
        rgb = data.grey(rgb)
    elif variant == "green":
        rgb = data.green(rgb)
    elif variant == "far":
        small = [cv2.resize(a, None, fx=FAR, fy=FAR, interpolation=cv2.INTER_AREA) for a in (rgb, nail)]
        pads = [int(n / FAR) - n for n in small[0].shape[:2]]
        edges = (pads[0] // 2, pads[0] - pads[0] // 2, pads[1] // 2, pads[1] - pads[1] // 2)
        rgb = cv2.copyMakeBorder(small[0], *edges, cv2.BORDER_REPLICATE)
        nail = cv2.copyMakeBorder(small[1], *edges, cv2.BORDER_CONSTANT)
    return (np.clip(rgb, 0, 1) * 255 + 0.5).astype(np.uint8), (nail > 0.5).astype(np.uint8)


def with_truth(finds, nail):
    """Each find's best true nail and IoU with it: (index from 0 or -1, IoU); and the number of true nails."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(nail)
    answer = []
    for f in finds:
        (x, y), mask = f.second.box, f.second.mask
        under = labels[y:y + mask.shape[0], x:x + mask.shape[1]][mask]
        shared = np.bincount(under, minlength=count)
        iou = shared / (mask.sum() + stats[:, 4] - shared)
        iou[0] = 0
        best = int(iou.argmax())
        answer.append((best - 1, float(iou[best])))
    return answer, count - 1


def record(forward, rgb, nail, way="usual", **about):
    """One picture's finds, for `pickle`."""
    finds = find.finds(forward, rgb, **WAYS[way])
    matches, nails = with_truth(finds, nail)
    return dict(about, way=way, nails=nails, finds=finds, matches=matches)


def negatives(root):
    """A hundred hand-free pictures (family, half, u8 RGB): 40 of two held-out scenes, 60 drawn.

    Halves (a scene each, and every other drawing) calibrate for one another.
    """
    pictures = []
    for half, scene in enumerate(data.HELD_OUT_SCENES):
        parts = data.hand_free(root, scene)
        for part in parts:  # grows while it is walked: halves of parts, then of halves
            if len(parts) == 20:
                break
            middle = max(part.shape[:2]) // 2
            parts.append(part[:, middle:] if part.shape[1] > part.shape[0] else part[middle:])
        pictures += [("scene", half, p) for p in parts]
    for i in range(60):
        family = list(drawn.FAMILIES)[i // 2 % len(drawn.FAMILIES)]
        picture = drawn.picture(np.random.default_rng(NEGATIVE_SEED + i), 480, 640, family)
        pictures.append((family, i % 2, picture))
    return [(family, half, (p * 255 + 0.5).astype(np.uint8)) for family, half, p in pictures]


def gather(args):
    """Everything that one net finds."""
    root, runs = pathlib.Path(args.data), pathlib.Path(args.runs)
    forward = forward_of(runs / f"{args.name}.pt")
    fold = int(args.name[5:]) if args.name.startswith("fold-") else None
    records = []
    for picture in data.photographs(root):
        for variant in VARIANTS if picture.fold == fold else []:
            rgb, nail = varied(picture, variant)
            for way in WAYS:
                records.append(record(forward, rgb, nail, way, name=picture.name, variant=variant))
    for folder in sorted(pathlib.Path(args.phantoms).iterdir()):
        for ghost in data.phantoms(folder):
            rgb, nail = varied(ghost, "colour")
            variant = f"phantom-{folder.name}"
            records.append(record(forward, rgb, nail, name=ghost.name, variant=variant))
    for i, (family, half, rgb) in enumerate(negatives(root)):
        blank = np.zeros(rgb.shape[:2], np.uint8)
        records.append(record(forward, rgb, blank, name=f"{family}-{i}", variant="negative", half=half))
    with open(runs / f"{args.name}.finds", "wb") as file:
        pickle.dump(records, file)


def fitted(records):
    """Logistic coefficients (constant first) for IoU >= 0.5 of every find, with a small ridge."""
    pairs = [(find.features(f), m[1] >= 0.5) for r in records for f, m in zip(r["finds"], r["matches"])]
    assert pairs, "no other fold was gathered"
    x = np.array([np.r_[1, p[0]] for p in pairs])
    y = np.array([p[1] for p in pairs], float)
    w = np.zeros(x.shape[1])
    ridge = np.eye(len(w)) * 1.0
    ridge[0, 0] = 0
    for _ in range(50):
        p = 1 / (1 + np.exp(-x @ w))
        step = np.linalg.solve((x * (p * (1 - p))[:, None]).T @ x + ridge, x.T @ (p - y) + ridge @ w)
        w -= step
    return w


def judged(record, coefficients):
    """A picture's merged finds with confidence: (find, true nail or -1, IoU), one find at most for each true nail."""
    for f in record["finds"]:
        f.confidence = find.confidence(f, coefficients)
    match = {id(f): m for f, m in zip(record["finds"], record["matches"])}
    answer, taken = [], set()
    for f in find.merged(record["finds"]):
        nail, iou = match[id(f)]
        if nail in taken:
            nail, iou = -1, 0.0
        taken.add(nail if iou >= 0.5 else None)
        answer.append((f, nail, iou))
    return answer


def counts(rows, nails, threshold):
    """Recall at IoU 0.5 and 0.7 and precision (at 0.5) of finds at least this confident."""
    kept = [iou for f, _, iou in rows if f.confidence >= threshold]
    right = sum(iou >= 0.5 for iou in kept)
    return right / max(1, nails), sum(iou >= 0.7 for iou in kept) / max(1, nails), right / max(1, len(kept)), len(kept)


def load(runs):
    """Records of each net that was gathered, by name."""
    return {p.stem: pickle.load(open(p, "rb")) for p in sorted(pathlib.Path(runs).glob("*.finds"))}


def trained_on(gathered, but=None, half=None):
    """What the confidence is fitted on: photographs (the usual way) of all folds but one and hand-free pictures.

    Of the hand-free pictures, those of one half where `half` is given.
    """
    chosen = []
    for name, records in gathered.items():
        for r in records if name.startswith("fold") else []:
            if r["variant"] == "negative" and half in (None, r["half"]):
                chosen.append(r)
            elif r["variant"] in FITTED and r["way"] == "usual" and name != but:
                chosen.append(r)
    return chosen


def held_out(gathered, by_fold, by_half):
    """Merged finds of held-out photographs and hand-free pictures, judged by what was fitted without them."""
    rows = []
    for name, records in gathered.items():
        for r in records if name.startswith("fold") else []:
            if r["variant"] == "negative":
                rows += judged(r, by_half[r["half"]])
            elif r["variant"] in FITTED and r["way"] == "usual":
                rows += judged(r, by_fold[name])
    return rows


def confident_threshold(rows):
    """The lowest confidence from 0.40 (in steps of 0.01) with precision >= 0.95 on `held_out`'s finds."""
    steps = np.arange(0.4, 0.995, 0.01)
    return next((float(t) for t in steps if counts(rows, 1, t)[2] >= 0.95), 0.99)


def reliability(rows):
    """Lines: range of confidence, finds in it, their mean confidence, the share at IoU >= 0.5."""
    lines = ["| confidence | finds | mean | right |", "|---|---|---|---|"]
    edges = [0, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 1.001]
    for low, high in zip(edges, edges[1:]):
        inside = [(f.confidence, iou >= 0.5) for f, _, iou in rows if low <= f.confidence < high]
        if inside:
            mean, right = np.mean(inside, 0)
            lines.append(f"| {low:.2f}-{min(high, 1):.2f} | {len(inside)} | {mean:.3f} | {right:.3f} |")
    return lines


def table(gathered, coefficients, threshold):
    """Figures of each net and variant."""
    lines = ["| net | pictures | way | nails | recall 0.5 / 0.7, precision, finds >= 0.3 | the same, confident |",
             "|---|---|---|---|---|---|"]
    keys = sorted({(r["variant"], r["way"]) for rs in gathered.values() for r in rs if r["variant"] != "negative"})
    for variant, way in keys:
        together, everything = 0, []
        for name, records in gathered.items():
            chosen = [r for r in records if (r["variant"], r["way"]) == (variant, way)]
            if not chosen:
                continue
            rows = [row for r in chosen for row in judged(r, coefficients[name])]
            nails = sum(r["nails"] for r in chosen)
            lines.append(line(name, variant, way, nails, rows, threshold))
            if name != "all":
                together, everything = together + nails, everything + rows
        if together:
            lines.append(line("**folds**", variant, way, together, everything, threshold))
    return lines


def line(name, variant, way, nails, rows, threshold):
    """One line of `table`."""
    parts = []
    for t in (0.3, threshold):
        a, b, p, n = counts(rows, nails, t)
        parts.append(f"{a:.3f} / {b:.3f}, {p:.3f}, {n}")
    return f"| {name} | {variant} | {way} | {nails} | {parts[0]} | {parts[1]} |"


def negative_table(gathered, by_half, threshold):
    """Hand-free pictures without a find, by family."""
    lines = ["| net | family | pictures | with a confident find | with a find >= 0.3 |", "|---|---|---|---|---|"]
    for name, records in gathered.items():
        chosen = [r for r in records if r["variant"] == "negative"]
        for family in [*dict.fromkeys(r["name"].split("-")[0] for r in chosen), ""]:
            tops = [max([row[0].confidence for row in judged(r, by_half[r["half"]])], default=0.0)
                    for r in chosen if r["name"].startswith(family)]
            bad = [sum(t >= limit for t in tops) for limit in (threshold, 0.3)]
            lines.append(f"| {name} | {family or '**all**'} | {len(tops)} | {bad[0]} | {bad[1]} |")
    return lines


def write_finds(path, gathered, coefficients):
    """Every find of the held-out photographs, before merging, as CSV."""
    fields = ["fold", "photograph", "variant", "side", "area_px", "length_1_px", "mean_nail_1", "mean_core_1",
              "agreement", "mean_nail_2", "mean_core_2", "stayed", "length_2_px", "solid_2", "iou", "true_nail",
              "confidence", "kept"]
    with open(path, "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(fields)
        for name, records in gathered.items():
            for r in records if name.startswith("fold") else []:
                if r["variant"] not in FITTED or r["way"] != "usual":
                    continue
                kept = {id(f) for f, _, _ in judged(r, coefficients[name])}
                for f, (nail, iou) in zip(r["finds"], r["matches"]):
                    a, b = f.first, f.second
                    numbers = [a.length, a.nail, a.core, a.agreement, b.nail, b.core, f.stayed, b.length, b.solid, iou]
                    out.writerow([name[5:], r["name"], r["variant"], a.side, int(b.mask.sum()),
                                  *(f"{v:.3f}" for v in numbers), nail if iou > 0 else "",
                                  f"{f.confidence:.3f}", int(id(f) in kept)])


def figures(args):
    """Writes the three files."""
    gathered, out = load(args.runs), pathlib.Path(args.out)
    by_fold = {name: fitted(trained_on(gathered, name)) for name in gathered}
    by_half = [fitted(trained_on(gathered, half=1 - half)) for half in range(2)]
    final = fitted(trained_on(gathered))
    rows = held_out(gathered, by_fold, by_half)
    threshold = confident_threshold(rows)
    lines = ["# Figures", "", f"Confident: from {threshold:.2f}.", "", *table(gathered, by_fold, threshold), "",
             "Hand-free pictures:", "", *negative_table(gathered, by_half, threshold), "",
             "Reliability on held-out photographs and hand-free pictures, coefficients fitted without them:", "",
             *reliability(rows)]
    (out / "figures.md").write_text("\n".join(lines) + "\n")
    named = zip(["constant", *find.FEATURES], final)
    (out / "calibration.txt").write_text("".join(f"{k} {v:.5f}\n" for k, v in named) + f"confident {threshold:.2f}\n")
    write_finds(out / "finds.csv", gathered, by_fold)
    print("\n".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["gather", "figures"])
    parser.add_argument("--data", default=os.environ.get("LUNULA_REAL_DATA"))
    parser.add_argument("--phantoms", help="phantoms of a seed that training didn't see")
    parser.add_argument("--runs", required=True)
    parser.add_argument("--name", help="fold-0, fold-1, fold-2 or all")
    parser.add_argument("--out", default=".")
    args = parser.parse_args()
    torch.set_num_threads(1)
    gather(args) if args.what == "gather" else figures(args)


if __name__ == "__main__":
    main()
