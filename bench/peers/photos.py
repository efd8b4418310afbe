"""The photos job as a user of Python would write it: the peer of `cargo bench --bench photos`.

usage: photos.py opencv|skimage SET OUT [PROCESSES [nearest|linear|cubic [REPEATS]]]

SET as `lunula phantom photos` writes it, outlines and axes in LabelMe. Writes what `lunula photos` writes: normalized
pictures, maps, figures, sheets (without captions) and nails.csv. Prints a line of JSON: for each of REPEATS, the seconds
that resampling one photograph in its nail's frame took on average.
"""

import csv
import json
import math
import multiprocessing
import os
import sys
import time

import numpy as np

PEER, SET, OUT = sys.argv[1:4]
PROCESSES = int(sys.argv[4]) if len(sys.argv) > 4 else 1
KERNEL = ("nearest", "linear", "cubic").index(sys.argv[5] if len(sys.argv) > 5 else "cubic")
REPEATS = int(sys.argv[6]) if len(sys.argv) > 6 else 1
SIZE, NAIL = 400, 320

if PEER == "opencv":
    import cv2

    cv2_kernel = (cv2.INTER_NEAREST, cv2.INTER_LINEAR, cv2.INTER_CUBIC)[KERNEL]
    if PROCESSES > 1 or len(sys.argv) > 6:
        cv2.setNumThreads(1)

    def read(path):
        return cv2.imread(path, cv2.IMREAD_COLOR)[:, :, 1]

    def write(path, picture):
        cv2.imwrite(path, picture)

    def warp(green, matrix):
        return cv2.warpAffine(green, matrix[:2], (SIZE, SIZE), flags=cv2_kernel | cv2.WARP_INVERSE_MAP,
                              borderMode=cv2.BORDER_REPLICATE)
else:
    from skimage import io, transform

    def read(path):
        return io.imread(path)[:, :, 1]

    def write(path, picture):
        io.imsave(path, picture, check_contrast=False)

    def warp(green, matrix):
        warped = transform.warp(green, transform.AffineTransform(matrix), output_shape=(SIZE, SIZE), order=(0, 1, 3)[KERNEL],
                                mode="edge", preserve_range=True)
        return np.clip(np.round(warped), 0, 255).astype(np.uint8)


def frame(path):
    shapes = json.load(open(path))["shapes"]
    outline = np.array(next(s for s in shapes if s["label"] == "nail")["points"]) - 0.5
    proximal, distal = np.array(next(s for s in shapes if s["label"] == "axis")["points"])
    angle = math.atan2(distal[0] - proximal[0], -(distal[1] - proximal[1]))
    right = np.array([math.cos(angle), math.sin(angle)])
    up = np.array([math.sin(angle), -math.cos(angle)])
    across, along = outline @ right, outline @ up
    width, length = np.ptp(across), np.ptp(along)
    centre = right * (across.min() + width / 2) + up * (along.min() + length / 2)
    column, row = right * width / NAIL, -up * length / NAIL
    origin = centre - (column + row) * (SIZE - 1) / 2
    matrix = np.array([[column[0], row[0], origin[0]], [column[1], row[1], origin[1]], [0, 0, 1]])
    return matrix, [*centre, length, width, math.degrees(angle)]


def stretch(values, low, high):
    return np.clip((values - low) / (high - low) * 255 + 0.5, 0, 255).astype(np.uint8)


def pose_job(pose):
    os.makedirs(f"{OUT}/normalized/{pose}", exist_ok=True)
    pictures, rows, seconds = [], [], [0.0] * REPEATS
    for name in sorted(n for n in os.listdir(f"{SET}/{pose}") if n.endswith(".png")):
        subject = name[:-4]
        matrix, box = frame(f"{SET}/{pose}/{subject}.json")
        green = read(f"{SET}/{pose}/{name}")
        if REPEATS > 1:
            warp(green, matrix)  # warms up
        for k in range(REPEATS):
            start = time.perf_counter()
            normalized = warp(green, matrix)
            seconds[k] += time.perf_counter() - start
        write(f"{OUT}/normalized/{pose}/{name}", normalized)
        pictures.append(normalized)
        rows.append([f"{pose}/{name}", 1, subject, pose, "annotated", 1, *box, "true", ""])
    stack = np.stack(pictures).astype(np.float32) / 255
    mean, sd = stack.mean(0), stack.std(0, ddof=1)
    np.save(f"{OUT}/maps/{pose}-mean.npy", mean)
    np.save(f"{OUT}/maps/{pose}-sd.npy", sd)
    np.save(f"{OUT}/maps/{pose}-count.npy", np.full(mean.shape, len(pictures), np.uint32))
    figures = {
        "mean": stretch(mean, 0, 1),
        "contrast": stretch(mean, 0.3, 0.5),
        "threshold": np.where(mean > 105 / 255, 255, 0).astype(np.uint8),
        "sd": stretch(sd, 0, 0.2),
    }
    for kind, picture in figures.items():
        write(f"{OUT}/figures/{pose}-{kind}.png", picture)
    return rows, figures, seconds


def main():
    for folder in ("maps", "figures"):
        os.makedirs(f"{OUT}/{folder}", exist_ok=True)
    poses = sorted(os.listdir(SET))
    if PROCESSES > 1:
        with multiprocessing.Pool(PROCESSES) as pool:
            done = pool.map(pose_job, poses, chunksize=1)
    else:
        done = [pose_job(pose) for pose in poses]
    for kind in ("mean", "contrast", "threshold", "sd"):
        tiles = [figures[kind] for _, figures, _ in done]
        write(f"{OUT}/figures/{kind}.png", np.vstack([np.hstack(tiles[k:k + 4]) for k in range(0, len(tiles), 4)]))
    with open(f"{OUT}/nails.csv", "w", newline="") as table:
        writer = csv.writer(table)
        writer.writerow("file nail subject pose outline confidence center_x_px center_y_px length_px width_px axis_deg used reason".split())
        writer.writerows(row for rows, _, _ in done for row in rows)
    photographs = sum(len(rows) for rows, _, _ in done)
    print(json.dumps({"seconds": [sum(s[k] for _, _, s in done) / photographs for k in range(REPEATS)]}))


main()
