"""From the net's probabilities to nails on a whole photograph.

1. *First look*: the photograph in three sizes (`SIDES`: long side 128, 256 and 512 px), padded with black on the right
   and below to multiples of 32. Output cells are 2 px of that size. `FAR_SIDE` is added where nothing good and large
   enough was found (`far_needed`).
2. Cells with core > 0.5 and nail > 0.5 fall into 4-connected components; each grows, a ring of 4-neighbours a time,
   into cells with nail > 0.5 until all are taken; where two meet, the cell goes to the component found first (row by
   row). Components under 4 cells are dropped.
3. Each gets its best IoU with a component of another size (*agreement*). Of components that overlap, the one of the
   best `quality` stays: a *candidate*.
4. *Second look*: a window of the photograph around the candidate's centroid, scaled so that the candidate is 40 px long
   and the window 160 px. The component there with the largest IoU with the candidate is the nail; without one the
   candidate is dropped.
5. A logistic formula of both looks (`features`) gives the confidence. Of finds that overlap, the most confident stays.
"""

from dataclasses import dataclass

import cv2
import numpy as np

SIDES = (128, 256, 512)
FAR_SIDE = 1024
NAIL = CORE = 0.5  # thresholds of probability
SMALLEST = 4  # cells
SAME = 0.3  # components that share so much of the smaller one are of one nail
BEST_LENGTH = 28.0  # px at the size looked at, the middle of what training shows (9-85 px)
WINDOW, SECOND_LENGTH = 160, 40.0  # px of the second look
FAR_LENGTH, FAR_FROM = 20.0, 600  # see `far_needed`


@dataclass
class Component:
    """A component: its mask in pixels of the photograph and what was measured of it."""
    side: int
    mask: np.ndarray  # bool, of the box only
    box: tuple  # x, y of the box's corner in the photograph
    length: float  # px at the size looked at: 4 standard deviations along its principal axis
    width: float  # likewise across
    nail: float  # mean probability of nail in the mask
    core: float  # mean probability of core in the core's cells
    solid: float  # area over the area of the ellipse of the same second moments
    scale: float  # of the size looked at, px for each pixel of the photograph
    agreement: float = 0.0  # best IoU with a component of another size


@dataclass
class Find:
    """A candidate and what the second look made of it."""
    first: Component
    second: Component
    stayed: float  # IoU of the two
    confidence: float = 0.0


def resized(rgb, scale):
    """The picture (u8) at this scale, padded to multiples of 32: `1x3xhxw` f32 in 0..1."""
    way = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    height, width = (max(1, round(n * scale)) for n in rgb.shape[:2])
    small = cv2.resize(rgb, (width, height), interpolation=way)
    small = cv2.copyMakeBorder(small, 0, -height % 32, 0, -width % 32, cv2.BORDER_CONSTANT)
    return small.astype(np.float32).transpose(2, 0, 1)[None] / 255


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
    """Those of one pass: `probability` is `2 x h x w` in cells, `shape` the photograph's height and width."""
    nail, core = probability
    labels, seeds, count = grown(core > CORE, nail > NAIL)
    answer = []
    for label in range(1, count):
        ys, xs = np.nonzero(labels == label)
        if len(xs) < SMALLEST:
            continue
        moments = np.cov(np.stack([xs, ys])) + np.eye(2) / 12
        small, large = np.sqrt(np.maximum(np.linalg.eigvalsh(moments), 1 / 12))
        patch = (labels[ys.min():ys.max() + 1, xs.min():xs.max() + 1] == label).astype(np.float32)
        mask, box = in_photograph(patch, xs.min(), ys.min(), 2 / scale, shape)
        if mask.any():
            solid = float(len(xs) / (4 * np.pi * small * large))
            answer.append(Component(side, mask, box, 8 * large, 8 * small, float(nail[ys, xs].mean()),
                                    float(core[seeds == label].mean()), solid, scale))
    return answer


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
    """Pixels that two components share, those of the smaller and those of both."""
    x0, y0 = max(a.box[0], b.box[0]), max(a.box[1], b.box[1])
    x1 = min(a.box[0] + a.mask.shape[1], b.box[0] + b.mask.shape[1])
    y1 = min(a.box[1] + a.mask.shape[0], b.box[1] + b.mask.shape[0])
    areas = int(a.mask.sum()), int(b.mask.sum())
    if x1 <= x0 or y1 <= y0:
        return 0, min(areas), sum(areas)
    parts = [f.mask[y0 - f.box[1]:y1 - f.box[1], x0 - f.box[0]:x1 - f.box[0]] for f in (a, b)]
    shared = int((parts[0] & parts[1]).sum())
    return shared, min(areas), sum(areas) - shared


def iou(a, b):
    """Intersection over union of two components."""
    shared, _, both = overlap(a, b)
    return shared / both


def one_each(components, key):
    """Of components (or what `key`'s second part makes of them) that overlap, the first by the key's first part."""
    kept = []
    for c in sorted(components, key=lambda c: -key(c)[0]):
        if all(shared <= SAME * smaller for shared, smaller, _ in (overlap(key(c)[1], key(k)[1]) for k in kept)):
            kept.append(c)
    return kept


def logit(p):
    """Log odds, bounded."""
    p = min(max(p, 0.01), 0.99)
    return float(np.log(p / (1 - p)))


def quality(c):
    """Which of two looks at one nail is the better one."""
    return logit(c.nail) + logit(c.core) - 2 * abs(np.log(c.length / BEST_LENGTH))


def far_needed(components, shape):
    """Whether nails may be too small for the usual sizes: none that is sure (mean probabilities) is long enough."""
    sure = [c for c in components if c.nail > 0.8 and c.core > 0.8 and c.side == max(SIDES)]
    return max(shape) >= FAR_FROM and not any(c.length >= FAR_LENGTH for c in sure)


def look(forward, rgb, side):
    """Components at one size. `forward`: `1x3xhxw` f32 in 0..1 to `2 x h/2 x w/2`."""
    scale = side / max(rgb.shape[:2])
    return components(forward(resized(rgb, scale)), side, scale, rgb.shape[:2])


def look_again(forward, rgb, first):
    """The second look at a candidate: a `Find` or None."""
    scale = SECOND_LENGTH * first.scale / first.length
    ys, xs = np.nonzero(first.mask)
    x, y, half = xs.mean() + first.box[0], ys.mean() + first.box[1], WINDOW / 2 / scale
    x0, y0 = max(0, round(x - half)), max(0, round(y - half))
    window = rgb[y0:max(y0 + 1, round(y + half)), x0:max(x0 + 1, round(x + half))]
    best = None
    for c in components(forward(resized(window, scale)), WINDOW, scale, window.shape[:2]):
        c.box = (c.box[0] + x0, c.box[1] + y0)
        stayed = iou(first, c)
        if stayed > (best.stayed if best else 0):
            best = Find(first, c, stayed)
    return best


def finds(forward, rgb, sides=SIDES, far=True):
    """All finds on a photograph (u8 RGB), without confidence."""
    parts = [c for side in sides for c in look(forward, rgb, side)]
    if far and far_needed(parts, rgb.shape[:2]):
        parts += look(forward, rgb, FAR_SIDE)
    for c in parts:
        c.agreement = max((iou(c, other) for other in parts if other.side != c.side), default=0.0)
    again = [look_again(forward, rgb, c) for c in one_each(parts, lambda c: (quality(c), c))]
    return [f for f in again if f]


FEATURES = ["nail_1", "core_1", "agreement", "log_length_1", "nail_2", "core_2", "stayed", "log_length_2", "solid_2"]


def features(f):
    """What the confidence is made of, each about -2..2, in the order of FEATURES."""
    a, b = f.first, f.second
    return np.array([
        logit(a.nail) - 2, logit(a.core) - 2, a.agreement, np.log(a.length / BEST_LENGTH),
        logit(b.nail) - 2, logit(b.core) - 2, f.stayed, np.log(b.length / SECOND_LENGTH), min(b.solid, 1.2) - 0.95,
    ])


def confidence(f, coefficients):
    """Calibrated probability that a find is a nail outlined at IoU 0.5 or better."""
    return float(1 / (1 + np.exp(-(coefficients[0] + features(f) @ np.array(coefficients[1:])))))


def merged(found):
    """Of finds that overlap, the most confident."""
    return one_each(found, lambda f: (f.confidence, f.second))
