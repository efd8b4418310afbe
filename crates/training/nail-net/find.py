"""From the net's probabilities to nails on a whole photograph.

1. The photograph is looked at in three sizes (`SIDES`: long side 128, 256 and 512 px), padded with black on the right
   and below to multiples of 32. Output cells are 2 px of that size.
2. Cells with core > 0.5 and nail > 0.5 fall into 4-connected components; each grows, a ring of 4-neighbours a time, into
   cells with nail > 0.5 until all are taken; where two meet, the cell goes to the component found first.
3. Components under 4 cells are dropped. Each gets `Features`, among them its best overlap with a component of
   another size, and from them a confidence.
4. Of components of any sizes that overlap, the most confident stays.
"""

from dataclasses import dataclass

import cv2
import numpy as np

SIDES = (128, 256, 512)
FAR_SIDE = 1024
NAIL = CORE = 0.5  # thresholds of probability
SMALLEST = 4  # cells
SAME = 0.3  # two finds that overlap by so much (intersection over the smaller) are of one nail


@dataclass
class Find:
    """A component: its mask in pixels of the photograph and what was measured of it."""
    side: int
    mask: np.ndarray  # bool, of the box only
    box: tuple  # x, y of the box's corner in the photograph
    length: float  # px at the size looked at: 4 standard deviations along its principal axis
    width: float  # likewise across
    nail: float  # mean probability of nail in the mask
    core: float  # mean probability of core in the core's cells
    solid: float  # area over the area of the ellipse of the same second moments
    agreement: float = 0.0  # best IoU with a component of another size
    confidence: float = 0.0


def resized(rgb, side):
    """The picture (u8) with this long side, padded to multiples of 32, and the scale."""
    scale = side / max(rgb.shape[:2])
    way = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    height, width = (max(1, round(n * scale)) for n in rgb.shape[:2])
    small = cv2.resize(rgb, (width, height), interpolation=way)
    return cv2.copyMakeBorder(small, 0, -height % 32, 0, -width % 32, cv2.BORDER_CONSTANT), scale


def grown(core, nail):
    """Labels of the components of `core`, grown within `nail`, and the labels of the cores themselves."""
    count, labels = cv2.connectedComponents((core & nail).astype(np.uint8), connectivity=4)
    seeds, cross = labels.copy(), np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], np.uint8)
    labels = labels.astype(np.float32)
    far = np.float32(count + 1)
    while True:
        spread = cv2.erode(np.where(labels > 0, labels, far), cross, borderValue=float(far))
        free = nail & (labels == 0) & (spread < far)
        if not free.any():
            return labels.astype(np.int32), seeds, count
        labels[free] = spread[free]


def components(probability, side, scale, shape):
    """Finds of one pass: `probability` is `2 x h x w` in cells, `shape` the photograph's height and width."""
    nail, core = probability
    labels, seeds, count = grown(core > CORE, nail > NAIL)
    finds = []
    for label in range(1, count):
        ys, xs = np.nonzero(labels == label)
        if len(xs) < SMALLEST:
            continue
        moments = np.cov(np.stack([xs, ys])) + np.eye(2) / 12
        small, large = np.sqrt(np.maximum(np.linalg.eigvalsh(moments), 1 / 12))
        patch = (labels[ys.min():ys.max() + 1, xs.min():xs.max() + 1] == label).astype(np.float32)
        mask, box = in_photograph(patch, xs.min(), ys.min(), 2 / scale, shape)
        if mask.any():
            finds.append(Find(side, mask, box, 8 * large, 8 * small, float(nail[ys, xs].mean()),
                              float(core[seeds == label].mean()), float(len(xs) / (4 * np.pi * small * large))))
    return finds


def in_photograph(patch, x, y, cell, shape):
    """A patch of cells at (x, y) as a mask in pixels and its corner; `cell` is a cell's side in pixels."""
    left, top = int(np.floor((x - 1) * cell)), int(np.floor((y - 1) * cell))
    left, top = max(left, 0), max(top, 0)
    right = min(int(np.ceil((x + patch.shape[1] + 1) * cell)), shape[1])
    bottom = min(int(np.ceil((y + patch.shape[0] + 1) * cell)), shape[0])
    if right <= left or bottom <= top:
        return np.zeros((1, 1), bool), (0, 0)
    to_cells = np.array([[1 / cell, 0, (left + 0.5) / cell - 0.5 - x], [0, 1 / cell, (top + 0.5) / cell - 0.5 - y]])
    smooth = cv2.warpAffine(patch, to_cells, (right - left, bottom - top),
                            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_CONSTANT)
    return smooth > 0.5, (left, top)


def overlap(a, b):
    """Pixels that two finds share, and of the smaller and of both."""
    x0, y0 = max(a.box[0], b.box[0]), max(a.box[1], b.box[1])
    x1 = min(a.box[0] + a.mask.shape[1], b.box[0] + b.mask.shape[1])
    y1 = min(a.box[1] + a.mask.shape[0], b.box[1] + b.mask.shape[0])
    areas = int(a.mask.sum()), int(b.mask.sum())
    if x1 <= x0 or y1 <= y0:
        return 0, min(areas), sum(areas)
    parts = [f.mask[y0 - f.box[1]:y1 - f.box[1], x0 - f.box[0]:x1 - f.box[0]] for f in (a, b)]
    shared = int((parts[0] & parts[1]).sum())
    return shared, min(areas), sum(areas) - shared


def features(find):
    """What the confidence is made of, each about -2..2."""
    size = np.log(max(find.length, 1) / 28)
    return np.array([logit(find.nail) - 2, logit(find.core) - 2, size, size * size, find.agreement,
                     min(find.solid, 1.2) - 0.95, np.log(find.length / find.width) - 0.35])


FEATURES = ["nail_logit_2", "core_logit_2", "log_length_28", "log_length_28_squared", "agreement", "solid_095",
            "log_aspect_035"]


def logit(p):
    """Log odds, bounded."""
    p = min(max(p, 0.01), 0.99)
    return float(np.log(p / (1 - p)))


def confidence(find, coefficients):
    """Calibrated probability that a find is a nail outlined at IoU 0.5 or better."""
    return float(1 / (1 + np.exp(-(coefficients[0] + features(find) @ np.array(coefficients[1:])))))


def all_finds(forward, rgb, sides=SIDES):
    """Components of all sizes with their agreement. `forward`: `1x3xhxw` f32 in 0..1 to `2 x h/2 x w/2`."""
    passes = {}
    for side in sides:
        small, scale = resized(rgb, side)
        probability = forward(small.astype(np.float32).transpose(2, 0, 1)[None] / 255)
        passes[side] = components(probability, side, scale, rgb.shape[:2])
    for side, finds in passes.items():
        others = [g for s, fs in passes.items() if s != side for g in fs]
        for find in finds:
            find.agreement = max((shared / whole for shared, _, whole in (overlap(find, g) for g in others)), default=0.0)
    return [f for fs in passes.values() for f in fs]


def merged(finds):
    """Of finds that overlap, the most confident."""
    kept = []
    for find in sorted(finds, key=lambda f: -f.confidence):
        if all(shared <= SAME * smaller for shared, smaller, _ in (overlap(find, k) for k in kept)):
            kept.append(find)
    return kept
