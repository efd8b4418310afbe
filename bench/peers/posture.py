"""The posture job's tracking as a user of Python would write it: the peer of `lunula posture`.

usage: posture.py VIDEO MARKERS.toml [OUT.csv] [THREADS]

VIDEO and MARKERS.toml as `lunula phantom video` writes them. Each whole frame to HSV, a mask of each colour's range of hue,
its largest contours, their centroids; markers of one colour keep to their last places. Writes frame,time_s,marker,x_px,y_px
and prints the seconds that it took.
"""

import csv
import sys
import time
import tomllib

import cv2
import numpy as np

VIDEO, MARKERS = sys.argv[1:3]
OUT = sys.argv[3] if len(sys.argv) > 3 else None
if len(sys.argv) > 4:
    cv2.setNumThreads(int(sys.argv[4]))

HUE_TOLERANCE, LEAST_SATURATION, LEAST_VALUE, LEAST_AREA_PX2 = 8, 0.5, 0.4, 30.0


def ranges(colour):
    bgr = np.array([[[int(colour[k : k + 2], 16) for k in (5, 3, 1)]]], np.uint8)
    hue, saturation, value = (int(part) for part in cv2.cvtColor(bgr, cv2.COLOR_BGR2HSV)[0, 0])
    least = [LEAST_SATURATION * saturation, LEAST_VALUE * value]
    low, high = hue - HUE_TOLERANCE, hue + HUE_TOLERANCE
    spans = [(max(low, 0), min(high, 179))]
    if low < 0:
        spans.append((low + 180, 179))
    if high > 179:
        spans.append((0, high - 180))
    return [(np.array([a, *least], float), np.array([b, 255, 255], float)) for a, b in spans]


def blobs(hsv, spans, count):
    mask = cv2.inRange(hsv, *spans[0])
    for span in spans[1:]:
        mask |= cv2.inRange(hsv, *span)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    large = sorted((c for c in contours if cv2.contourArea(c) >= LEAST_AREA_PX2), key=cv2.contourArea, reverse=True)
    moments = (cv2.moments(contour) for contour in large[:count])
    return [np.array([m["m10"] / m["m00"], m["m01"] / m["m00"]]) for m in moments]


def assign(names, found, last):
    """To the nearest last place, the nearest pair first; from left to right among those that have none."""
    places = {}
    pairs = [(np.linalg.norm(at - last[n]), n, k) for n in names if n in last for k, at in enumerate(found)]
    used = set()
    for _, name, k in sorted(pairs):
        if name not in places and k not in used:
            places[name] = found[k]
            used.add(k)
    rest = sorted((at for k, at in enumerate(found) if k not in used), key=lambda at: at[0])
    places.update(zip((n for n in names if n not in last), rest))
    last.update(places)
    return places


layout = tomllib.load(open(MARKERS, "rb"))
by_colour = {}
for name, colour in layout["markers"].items():
    by_colour.setdefault(colour, []).append(name)
colours = [(ranges(colour), names) for colour, names in by_colour.items()]
last = {name: np.array(at) for name, at in layout.get("start", {}).items()}

rows, frames = [], 0
start = time.perf_counter()
capture = cv2.VideoCapture(VIDEO)
while True:
    there, picture = capture.read()
    if not there:
        break
    time_s = capture.get(cv2.CAP_PROP_POS_MSEC) / 1000
    hsv = cv2.cvtColor(picture, cv2.COLOR_BGR2HSV)
    for spans, names in colours:
        for name, at in assign(names, blobs(hsv, spans, len(names)), last).items():
            rows.append([frames, f"{time_s:.6f}", name, f"{at[0]:.4f}", f"{at[1]:.4f}"])
    frames += 1
seconds = time.perf_counter() - start

if OUT:
    with open(OUT, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["frame", "time_s", "marker", "x_px", "y_px"])
        writer.writerows(rows)
wanted = frames * len(layout["markers"])
print(f"{seconds:.3f} s, {frames} frames, {len(rows)} of {wanted} markers found")
