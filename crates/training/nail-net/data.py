"""Photographs with masks, phantoms, hand-free pictures, and what training makes of them.

Pictures are RGB f32 in 0..1, `height x width x 3`; masks are f32 in 0..1, `height x width`: *nail*, its *core* and the
*hand*. A sample is a square picture with masks of nail and core.
"""

import csv
import hashlib
import json
import pathlib
from dataclasses import dataclass, field

import cv2
import numpy as np

import drawn

DARKEST = np.array([0.55, 0.40, 0.28], np.float32)  # gain of R, G, B from light skin to dark brown, assumed
SMALLEST_NAIL = 100  # a mask's component under so many pixels is a crumb of the JPEG, not a nail
CORE = 0.35  # the core is where the distance to the mask's edge exceeds this part of the largest
TRAINED_SCENES = range(30)  # of ti1k's sorted files: gardens and a lecture room
HELD_OUT_SCENES = (range(30, 36), range(36, 40))  # a room with a cupboard; a garden with flowers


@dataclass
class Picture:
    """A picture with its masks, also halved as often as warping needs."""
    name: str
    rgb: np.ndarray
    nail: np.ndarray
    core: np.ndarray
    hand: np.ndarray
    fold: int = -1
    nails: list = field(default_factory=list)  # (x, y, longest side of the box) of each
    levels: list = field(default_factory=list)

    def __post_init__(self):
        _, _, stats, centres = cv2.connectedComponentsWithStats((self.nail > 0.5).astype(np.uint8))
        self.nails = [(x, y, max(s[2:4])) for s, (x, y) in zip(stats[1:], centres[1:])]
        level = np.dstack([self.rgb, self.nail, self.core, self.hand]).astype(np.float32)
        while min(level.shape[:2]) > 24:
            self.levels.append(level)
            level = cv2.resize(level, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        whole = self.levels[0]  # views of it: a third less memory
        self.rgb, self.nail, self.core, self.hand = whole[:, :, :3], whole[:, :, 3], whole[:, :, 4], whole[:, :, 5]


def read_rgb(path):
    """A picture file as RGB f32 in 0..1."""
    return cv2.imread(str(path), cv2.IMREAD_COLOR)[:, :, ::-1].astype(np.float32) / 255


def core_of(nail):
    """The core of each of a mask's components: where the edge is far."""
    count, labels = cv2.connectedComponents((nail > 0.5).astype(np.uint8))
    distance = cv2.distanceTransform((nail > 0.5).astype(np.uint8), cv2.DIST_L2, 5)
    core = np.zeros_like(nail, np.float32)
    for label in range(1, count):
        inside = labels == label
        core[inside & (distance > CORE * distance[inside].max())] = 1
    return core


def without_crumbs(mask):
    """A boolean mask less its components under SMALLEST_NAIL pixels, as f32."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    kept = stats[:, 4] >= SMALLEST_NAIL
    kept[0] = False
    return kept[labels].astype(np.float32)


def hand_of(rgb, nail):
    """Where the hand is, by GrabCut from the colour of the skin around the nails."""
    scale = 320 / max(nail.shape)
    small = cv2.resize((rgb[:, :, ::-1] * 255).astype(np.uint8), None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    inside = cv2.resize(nail, small.shape[1::-1], interpolation=cv2.INTER_AREA) > 0.5
    ring = cv2.dilate(inside.astype(np.uint8), np.ones((9, 9))) > 0
    hue = cv2.cvtColor(small, cv2.COLOR_BGR2LAB)[:, :, 1:].astype(np.float32)
    samples = hue[ring & ~inside]
    middle = np.median(samples, 0)
    near = samples[np.abs(samples - middle).sum(1) < 14]
    spread = np.cov(near.T) + 4 * np.eye(2)
    off = hue - near.mean(0)
    distance = np.einsum("hwi,ij,hwj->hw", off, np.linalg.inv(spread), off)
    state = np.where(distance < 9, cv2.GC_PR_FGD, cv2.GC_PR_BGD).astype(np.uint8)
    state[distance > 60] = cv2.GC_BGD
    state[ring & (distance < 60)] = cv2.GC_PR_FGD
    state[inside] = cv2.GC_FGD
    cv2.setRNGSeed(1)
    cv2.grabCut(small, state, None, np.zeros((1, 65)), np.zeros((1, 65)), 3, cv2.GC_INIT_WITH_MASK)
    found = ((state == cv2.GC_FGD) | (state == cv2.GC_PR_FGD)).astype(np.uint8)
    found = cv2.morphologyEx(found, cv2.MORPH_CLOSE, np.ones((5, 5)))
    _, labels = cv2.connectedComponents(found)
    kept = np.isin(labels, np.unique(labels[inside])) & (labels > 0)
    soft = cv2.GaussianBlur(kept.astype(np.float32), (0, 0), 0.8)
    return cv2.resize(soft, nail.shape[::-1], interpolation=cv2.INTER_LINEAR)


def photographs(root):
    """The CC0 photographs with their masks and folds (`folds.csv`)."""
    rows = csv.DictReader(open(pathlib.Path(__file__).with_name("folds.csv")))
    folds = {row["photograph"]: int(row["fold"]) for row in rows}
    pictures = []
    for path in sorted((root / "nail/vpapenko_cc0/images").glob("*.jpg")):
        rgb = read_rgb(path)
        mask = cv2.imread(str(root / "nail/vpapenko_cc0/masks" / path.name), cv2.IMREAD_GRAYSCALE)
        nail = without_crumbs(mask > 127)
        name = path.stem[:8]
        pictures.append(Picture(name, rgb, nail, core_of(nail), hand_of(rgb, nail), folds[name]))
    return pictures


def phantoms(folder):
    """Phantom close-ups that `lunula phantom photos` made, with masks from their true outlines."""
    pictures = []
    for path in sorted(folder.glob("photos/*/*.png")):
        rgb = read_rgb(path)
        truth = json.loads((folder / "truth/outlines" / path.parent.name / f"{path.stem}.json").read_text())
        nail = np.zeros(rgb.shape[:2], np.float32)
        for shape in truth["shapes"]:
            cv2.fillPoly(nail, [np.round(np.array(shape["points"]) * 16).astype(np.int32)], 1.0, cv2.LINE_8, 4)
        blank = np.zeros_like(nail)
        pictures.append(Picture(f"{path.parent.name}/{path.stem}", rgb, nail, core_of(nail), blank))
    return pictures


def hand_free(root, scenes=TRAINED_SCENES):
    """Parts of these photographs of ti1k beside the hand, RGB."""
    answer, boxes = [], {}
    for line in (root / "nail/ti1k/labels.txt").read_text().splitlines():
        name, *numbers = line.split()
        boxes[name] = [float(n) for n in numbers[:4]]
    for name in [sorted(boxes)[i] for i in scenes]:
        rgb = read_rgb(root / "nail/ti1k" / name)
        height, width = rgb.shape[:2]
        left, top, right, bottom = boxes[name]
        x0, y0 = max(0, int((left - 0.06) * width)), max(0, int((top - 0.06) * height))
        x1 = min(width, int((right + 0.06) * width))
        parts = [rgb[:, :x0], rgb[:y0], rgb[:, x1:]]
        answer += [p for p in parts if min(p.shape[:2]) >= 64]
    return answer


def hashes(root):
    """SHA-256 over the names and bytes of each data folder that training reads."""
    answer = {}
    for folder in ("nail/vpapenko_cc0/images", "nail/vpapenko_cc0/masks", "nail/ti1k"):
        digest = hashlib.sha256()
        for path in sorted((root / folder).iterdir()):
            digest.update(path.name.encode() + b"\0" + path.read_bytes())
        answer[folder] = digest.hexdigest()
    return answer


# --- what training makes of them ------------------------------------------------------------------------------------


def darkened(rgb, hand, nail, depth, kept):
    """Skin brought towards dark brown: gain DARKEST^depth on the hand, less on nails (exponent times `kept`)."""
    power = depth * hand * (1 - (1 - kept) * nail)
    return rgb * DARKEST ** power[:, :, None]


def grey(rgb):
    """Luminance on all three channels."""
    return np.repeat((rgb @ np.array([0.299, 0.587, 0.114], np.float32))[:, :, None], 3, 2)


def green(rgb):
    """The green channel on all three."""
    return np.repeat(rgb[:, :, 1:2], 3, 2)


class Samples:
    """Endless training samples: squares of `size` pixels from photographs, phantoms and hand-free pictures."""

    def __init__(self, photos, ghosts, backgrounds, size, seed):
        self.photos, self.ghosts, self.backgrounds = photos, ghosts, backgrounds
        self.size, self.rng = size, np.random.default_rng(seed)
        weight = np.array([np.sqrt(len(p.nails)) for p in photos])
        self.weight = weight / weight.sum()

    def batch(self, count):
        """RGB `count x size x size x 3`, masks `count x size/2 x size/2 x 2` (both u8) and folds `count`."""
        return tuple(np.stack(parts) for parts in zip(*(self.sample() for _ in range(count))))

    def sample(self):
        """A picture, its masks and its fold (-1: none): 68 % photographs, 20 % phantoms, 12 % without a hand."""
        rng, kind, fold = self.rng, self.rng.random(), -1
        if kind < 0.68:
            photo = self.photos[rng.choice(len(self.photos), p=self.weight)]
            layers, fold = self.on_hand(self.crop(photo, 9, 85)), photo.fold
        elif kind < 0.88:
            layers = self.crop(self.ghosts[rng.integers(len(self.ghosts))], 18, 100)
        else:
            layers = np.zeros((self.size, self.size, 6), np.float32)
            layers[:, :, :3] = self.background()
        rgb = self.seen(np.ascontiguousarray(layers[:, :, :3]), layers[:, :, 3])
        half = (self.size // 2, self.size // 2)
        truth = cv2.resize(layers[:, :, 3:5], half, interpolation=cv2.INTER_AREA)
        return rgb, (np.clip(truth, 0, 1) * 255 + 0.5).astype(np.uint8), np.int64(fold)

    def crop(self, picture, shortest, longest):
        """Layers of a picture around one of its nails (or anywhere), turned, flipped, scaled, stretched."""
        rng, size = self.rng, self.size
        x, y, length = picture.nails[rng.integers(len(picture.nails))]
        scale = np.exp(rng.uniform(np.log(shortest), np.log(longest))) / length
        off = rng.uniform(-0.45, 0.45, 2) * size
        if rng.random() < 0.15:
            x, y = rng.uniform(0, picture.rgb.shape[1]), rng.uniform(0, picture.rgb.shape[0])
        level = int(np.clip(np.floor(-np.log2(scale) + 0.3), 0, len(picture.levels) - 1))
        angle = rng.uniform(-np.pi, np.pi) if picture.fold >= 0 or rng.random() < 0.5 else rng.normal(0, 0.4)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        stretch = np.exp(rng.uniform(-0.12, 0.12))
        matrix = turn @ np.diag([stretch, 1 / stretch]) * scale
        if rng.random() < 0.5:
            matrix = matrix @ np.diag([-1, 1])
        shift = size / 2 + off - matrix @ [x, y]
        half = 2.0 ** level
        shift = shift + matrix @ np.full(2, (half - 1) / 2)
        matrix = matrix * half
        small = max(picture.rgb.shape[:2]) * scale < size
        outside = cv2.BORDER_REFLECT_101 if picture.fold >= 0 and not small else cv2.BORDER_REPLICATE
        border = cv2.BORDER_CONSTANT if rng.random() < (0.7 if small and picture.fold >= 0 else 0.25) else outside
        return cv2.warpAffine(picture.levels[level], np.column_stack([matrix, shift]), (size, size),
                              flags=cv2.INTER_LINEAR, borderMode=border)

    def on_hand(self, layers):
        """Skin darkened on half, background replaced on a third."""
        rng = self.rng
        rgb, nail, hand = layers[:, :, :3], layers[:, :, 3], layers[:, :, 5]
        hand = np.maximum(hand, nail)
        if rng.random() < 0.5:
            rgb = darkened(rgb, hand, nail, rng.uniform(0.1, 1.1), rng.uniform(0.35, 0.85))
        if rng.random() < 1 / 3:
            rgb = rgb * hand[:, :, None] + self.background() * (1 - hand[:, :, None])
        layers[:, :, :3] = rgb
        return layers

    def background(self):
        """A hand-free square: half from photographs, half drawn."""
        rng, size = self.rng, self.size
        if rng.random() < 0.5:
            return drawn.picture(rng, size, size)
        part = self.backgrounds[rng.integers(len(self.backgrounds))]
        side = int(min(part.shape[:2]) * rng.uniform(0.4, 1))
        y, x = (int(rng.integers(0, n - side + 1)) for n in part.shape[:2])
        square = np.rot90(part[y:y + side, x:x + side], rng.integers(4))
        return cv2.resize(square, (size, size), interpolation=cv2.INTER_AREA)

    def seen(self, rgb, nail):
        """Light and camera: shadow, glare, white balance, gamma, grey, blur, noise, JPEG."""
        rng, size = self.rng, self.size
        if rng.random() < 0.3:
            rgb = rgb * self.shade()[:, :, None]
        if rng.random() < 0.25:
            rgb = self.glare(rgb, nail)
        rgb = rgb * np.exp(rng.normal(0, 0.12, 3) * [1, 0.5, 1] + rng.normal(-0.05, 0.22)).astype(np.float32)
        rgb = np.clip(rgb, 1e-4, 1) ** np.float32(np.exp(rng.normal(0, 0.25)))
        if rng.random() < 0.3:
            rgb = grey(rgb) + (rgb - grey(rgb)) * np.float32(rng.uniform(0.3, 1.5))
        kind = rng.random()
        rgb = grey(rgb) if kind < 0.1 else green(rgb) if kind < 0.18 else rgb
        if rng.random() < 0.4:
            rgb = cv2.GaussianBlur(rgb, (0, 0), rng.uniform(0.3, 1.6))
        if rng.random() < 0.4:
            rgb = rgb + rng.normal(0, rng.uniform(0.005, 0.04), rgb.shape).astype(np.float32)
        coded = (np.clip(rgb, 0, 1) * 255 + 0.5).astype(np.uint8)
        if rng.random() < 0.4:
            _, data = cv2.imencode(".jpg", coded, [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(25, 95))])
            coded = cv2.imdecode(data, cv2.IMREAD_COLOR)
        return coded

    def shade(self):
        """A soft-edged shadow across the square, or slow changes of light: gain `size x size`."""
        rng, size = self.rng, self.size
        if rng.random() < 0.5:
            return 0.4 + 0.9 * drawn.noise(rng, size, size, 2)
        y, x = np.mgrid[0:size, 0:size].astype(np.float32) / size - rng.uniform(0.2, 0.8)
        angle, soft = rng.uniform(0, 2 * np.pi), rng.uniform(0.01, 0.3)
        side = 1 / (1 + np.exp(-np.clip((x * np.cos(angle) + y * np.sin(angle)) / soft, -30, 30)))
        return (1 - rng.uniform(0.2, 0.7) * side).astype(np.float32)

    def glare(self, rgb, nail):
        """White spots, on nails where there are some."""
        rng, size = self.rng, self.size
        ys, xs = np.nonzero(nail > 0.5)
        spots = np.zeros((size, size), np.float32)
        for _ in range(rng.integers(1, 5)):
            i = rng.integers(len(xs)) if len(xs) else 0
            place = (int(xs[i]), int(ys[i])) if len(xs) else drawn.centre(rng, size, size)
            axes = (int(rng.uniform(1, 9)), int(rng.uniform(1, 4)))
            cv2.ellipse(spots, place, axes, rng.uniform(0, 180), 0, 360, rng.uniform(0.3, 1), -1)
        spots = cv2.GaussianBlur(spots, (0, 0), rng.uniform(0.5, 2.5))
        return rgb + (1 - rgb) * spots[:, :, None]
