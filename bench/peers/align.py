"""The alignment job as a user of Python would write it: the peer of `lunula align`.

usage: align.py JOINTS.csv LOG.csv OUT.csv [REPEATS]

Lit rows less the last unlit one before them, angles interpolated linearly at the rows' times by the line through clock_s. No
standard errors, no gaps, no certificate. Prints a line of JSON: the seconds of each of REPEATS, without loading pandas.
"""

import json
import sys
import time

import numpy as np
import pandas as pd


def job():
    joints, log = pd.read_csv(sys.argv[1]), pd.read_csv(sys.argv[2])
    photodiodes = [name for name in log.columns if name.startswith("P")]
    unlit = log[photodiodes].where(log["led"] == 0).ffill()
    lit = log[log["led"] == 1].copy()
    lit[photodiodes] -= unlit.loc[lit.index]
    slope, offset = np.polyfit(joints["time_s"], joints["clock_s"], 1)
    video_s = (lit["time_s"] - offset) / slope
    for name in joints.columns:
        if name.endswith("_deg"):
            lit[name] = np.interp(video_s, joints["time_s"], joints[name], left=np.nan, right=np.nan)
    lit.drop(columns="led").to_csv(sys.argv[3], index=False)


REPEATS = int(sys.argv[4]) if len(sys.argv) > 4 else 1
if REPEATS > 1:
    job()  # warms up
times = []
for _ in range(REPEATS):
    start = time.perf_counter()
    job()
    times.append(time.perf_counter() - start)
print(json.dumps({"seconds": times}))
