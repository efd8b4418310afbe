"""Pictures without nails, drawn: what a net that looks for nails should leave alone.

Each family draws RGB f32 pictures in 0..1 of any height and width from a numpy generator.
"""

import cv2
import numpy as np


def colour(rng, skin=False):
    """A colour; where `skin`, one that skin, wood or lips could have."""
    if skin:
        r = rng.uniform(0.25, 0.95)
        return np.array([r, r * rng.uniform(0.6, 0.85), r * rng.uniform(0.4, 0.75)], np.float32)
    return rng.uniform(0, 1, 3).astype(np.float32)


def noise(rng, height, width, cells):
    """Smooth noise of `cells` cells along the height, in 0..1: `height x width`."""
    small = rng.uniform(0, 1, (cells + 1, max(2, int(cells * width / height) + 1))).astype(np.float32)
    return cv2.resize(small, (width, height), interpolation=cv2.INTER_CUBIC)


def texture(rng, height, width):
    """Two colours mixed by noise of several sizes, perhaps stretched like wood or cloth."""
    mixed = sum(noise(rng, height, width, c) / (i + 1) for i, c in enumerate(rng.integers(2, 60, 3)))
    if rng.random() < 0.3:
        mixed = mixed + 0.4 * np.sin(np.arange(width) * rng.uniform(0.05, 1.5))[None].astype(np.float32)
    mixed = (mixed - mixed.min()) / (np.ptp(mixed) + 1e-6)
    first, second = colour(rng, rng.random() < 0.5), colour(rng, rng.random() < 0.5)
    return first + (second - first) * mixed[:, :, None] * rng.uniform(0.2, 1)


def centre(rng, height, width):
    """A random point as integers (x, y)."""
    return int(rng.uniform(0, width)), int(rng.uniform(0, height))


def dots(rng, height, width):
    """Red, pink or white dots and ellipses on any ground."""
    image = texture(rng, height, width) if rng.random() < 0.6 else np.ones((height, width, 3), np.float32) * colour(rng)
    image = np.ascontiguousarray(image)
    for _ in range(rng.integers(1, 12)):
        red = np.array([rng.uniform(0.5, 1), rng.uniform(0, 0.7), rng.uniform(0, 0.7)])
        axes = (int(rng.uniform(2, 35)), int(rng.uniform(2, 35)))
        cv2.ellipse(image, centre(rng, height, width), axes, rng.uniform(0, 360), 0, 360, red.tolist(), -1, cv2.LINE_AA)
    return image


def shapes(rng, height, width):
    """Rectangles, triangles, circles and lines in any colours."""
    image = np.ascontiguousarray(np.ones((height, width, 3), np.float32) * colour(rng))
    for _ in range(rng.integers(3, 25)):
        ink, kind = colour(rng, rng.random() < 0.5).tolist(), rng.integers(4)
        x, y = centre(rng, height, width)
        if kind == 0:
            corner = (x + int(rng.uniform(3, 90)), y + int(rng.uniform(3, 90)))
            cv2.rectangle(image, (x, y), corner, ink, -1 if rng.random() < 0.7 else 2)
        elif kind == 1:
            points = np.array([x, y]) + rng.uniform(-50, 50, (rng.integers(3, 7), 2))
            cv2.fillPoly(image, [points.astype(np.int32)], ink, cv2.LINE_AA)
        elif kind == 2:
            cv2.circle(image, (x, y), int(rng.uniform(2, 40)), ink, int(rng.choice([-1, 1, 3])), cv2.LINE_AA)
        else:
            cv2.line(image, (x, y), centre(rng, height, width), ink, int(rng.integers(1, 6)), cv2.LINE_AA)
    return image


def furniture(rng, height, width):
    """Boards, drawers with handles and screens in wood and grey, in perspective, with rounded parts."""
    image = np.ascontiguousarray(texture(rng, height, width) * 0.5 + 0.3)
    for _ in range(rng.integers(2, 9)):
        ink = colour(rng, True)
        x, y = centre(rng, height, width)
        w, h = rng.uniform(15, 150, 2)
        board = np.array([[0, 0], [w, 0], [w, h], [0, h]]) + rng.uniform(-15, 15, (4, 2)) + [x, y]
        cv2.fillPoly(image, [board.astype(np.int32)], ink.tolist(), cv2.LINE_AA)
        cv2.polylines(image, [board.astype(np.int32)], True, (ink * 0.5).tolist(), 2, cv2.LINE_AA)
        handle = (int(rng.uniform(3, 14)), int(rng.uniform(2, 8)))
        place = (int(x + w / 2), int(y + h / 2))
        cv2.ellipse(image, place, handle, 0, 0, 360, np.clip(ink * 1.4, 0, 1).tolist(), -1, cv2.LINE_AA)
    return image


def faces(rng, height, width):
    """Drawn faces: an oval with eyes, a mouth and cheeks."""
    image = np.ascontiguousarray(texture(rng, height, width))
    for _ in range(rng.integers(1, 4)):
        skin, r = colour(rng, True), rng.uniform(15, 80)
        x, y = centre(rng, height, width)
        cv2.ellipse(image, (x, y), (int(r * 0.8), int(r)), 0, 0, 360, skin.tolist(), -1, cv2.LINE_AA)
        for side in (-1, 1):
            eye = (int(x + side * r * 0.35), int(y - r * 0.25))
            axes = (int(r * 0.16) + 1, int(r * 0.1) + 1)
            cv2.ellipse(image, eye, axes, 0, 0, 360, (0.95, 0.95, 0.95), -1, cv2.LINE_AA)
            cv2.circle(image, eye, int(r * 0.07) + 1, colour(rng).tolist(), -1, cv2.LINE_AA)
            cheek = (int(x + side * r * 0.45), int(y + r * 0.2))
            pink = np.clip(skin * [1.15, 0.9, 0.95], 0, 1).tolist()
            cv2.circle(image, cheek, int(r * 0.15) + 1, pink, -1, cv2.LINE_AA)
        mouth = (rng.uniform(0.5, 1), rng.uniform(0.1, 0.5), rng.uniform(0.1, 0.5))
        place, axes = (int(x), int(y + r * 0.5)), (int(r * 0.3) + 1, int(r * 0.12) + 1)
        cv2.ellipse(image, place, axes, 0, 0, 360, mouth, -1, cv2.LINE_AA)
    return image


def fingers(rng, height, width):
    """Bare fingers seen from the pulp's side: skin-coloured, shaded, with creases, no nail."""
    image = np.ascontiguousarray(texture(rng, height, width) * rng.uniform(0.2, 1))
    skin, w = colour(rng, True), rng.uniform(8, 60)
    angle = rng.uniform(0, 2 * np.pi)
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    start = np.array(centre(rng, height, width), float)
    for i in range(rng.integers(1, 5)):
        tip = start + across * i * w * 1.1 + along * rng.uniform(-0.5, 0.5) * w
        for k in range(8):  # strips from dark edge to bright middle
            part = 1 - k / 8
            shade = np.clip(skin * (0.65 + 0.4 * (1 - part)), 0, 1).tolist()
            a, b = tip.astype(int).tolist(), (tip + along * w * 8).astype(int).tolist()
            cv2.line(image, a, b, shade, max(1, int(w * part)), cv2.LINE_AA)
        for crease in rng.uniform(1.2, 6, 3):
            middle = tip + along * crease * w
            a, b = middle - across * w * 0.4, middle + across * w * 0.4
            cv2.line(image, a.astype(int).tolist(), b.astype(int).tolist(), (skin * 0.55).tolist(), 1, cv2.LINE_AA)
        if rng.random() < 0.5:
            red = np.clip(skin * [1.15, 0.85, 0.85], 0, 1).tolist()
            cv2.circle(image, tip.astype(int).tolist(), max(1, int(w * 0.25)), red, -1, cv2.LINE_AA)
    return cv2.GaussianBlur(image, (0, 0), max(0.6, w * 0.04))


FAMILIES = {"texture": texture, "dots": dots, "shapes": shapes, "furniture": furniture, "faces": faces,
            "fingers": fingers}


def picture(rng, height, width, family=None):
    """A picture of a family, by default any: `height x width x 3`, RGB f32 in 0..1."""
    name = family or str(rng.choice(list(FAMILIES)))
    return np.clip(FAMILIES[name](rng, height, width), 0, 1).astype(np.float32)
