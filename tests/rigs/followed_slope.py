#!/usr/bin/env python3
"""Computes with numpy whether a navigation followed its samples, and compares the slopes with those of the scoring.

`cargo run --release -p octant-followed --example power -- --export FILE` writes a navigation at rest, once a second: truth,
answers and the sums of the noise in the samples. Nothing of the harness takes part in the computation: errors, windows of
10 s between the turns, a line in time taken from every two minutes, least squares on the noise turned into n.

Usage: python tests/rigs/followed_slope.py FOLDER     (FOLDER is filled)

Needs the packages of tests/rigs/requirements-export.txt. Exit status: 0 as expected, 1 with the slope that is another.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent
EARTH_RATE = 7.292115e-5
LATITUDE = np.radians(30.5)
GRAVITY = 9.7803253359 * (1 + 0.00193185265241 * np.sin(LATITUDE) ** 2) / np.sqrt(1 - 6.69437999014e-3 * np.sin(LATITUDE) ** 2)
WINDOW = 10
BLOCK = 12


def matrices(q):
    """Returns the matrices of quaternions (w, x, y, z) in rows."""
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def without_line(values):
    """Takes a line in time from the columns of a block."""
    time = np.arange(len(values))
    basis = np.stack([np.ones(len(values)), time - time.mean()], axis=1)
    return values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]


def slope(response, regressor, starts):
    """Slope over blocks of windows, north and east together, with its standard deviation."""
    x, y, free = [], [], -1
    for first in range(0, len(starts) - BLOCK + 1, BLOCK):
        block = slice(first, first + BLOCK)
        x.append(without_line(regressor[block]).ravel())
        y.append(without_line(response[block]).ravel())
        free += 2 * (BLOCK - 2)
    x, y = np.concatenate(x), np.concatenate(y)
    value = x @ y / (x @ x)
    return value, np.sqrt(np.sum((y - value * x) ** 2) / free / (x @ x))


def computed(file):
    """Slopes of attitude and velocity on the noise, each with its standard deviation."""
    data = np.loadtxt(file, delimiter=",", skiprows=1)
    truth, answer, velocity = data[:, 1:5], data[:, 5:9], data[:, 9:11]
    noise = np.diff(data[:, 13:19], axis=0)
    c_nb = matrices(truth)
    # (I - [phi x]) C: phi is the vector of the product with the true matrix, transposed.
    product = np.einsum("kij,klj->kil", matrices(answer), c_nb)
    phi = -0.5 * np.stack([product[:, 2, 1] - product[:, 1, 2], product[:, 0, 2] - product[:, 2, 0],
                           product[:, 1, 0] - product[:, 0, 1]], axis=1)
    rate = EARTH_RATE * np.array([np.cos(LATITUDE), 0, -np.sin(LATITUDE)])
    # No second in which the body turns.
    quiet = np.einsum("kij,kij->k", c_nb[1:], c_nb[:-1]) > 3 - 1e-6
    mean = 0.5 * (c_nb[1:] + c_nb[:-1])
    turned = -np.einsum("kij,kj->ki", mean, noise[:, :3])
    pushed = np.einsum("kij,kj->ki", mean, noise[:, 3:])
    starts, at = [], 0
    while at + WINDOW < len(data):
        if quiet[at:at + WINDOW].all():
            starts.append(at)
        at += WINDOW
    starts = np.array(starts)
    ends = starts + WINDOW
    drift = -np.cross(rate, 0.5 * (phi[starts] + phi[ends])) * WINDOW
    sums = np.concatenate([np.zeros((1, 3)), np.cumsum(turned, axis=0)])
    attitude = slope((phi[ends] - phi[starts] - drift)[:, :2], (sums[ends] - sums[starts])[:, :2], starts)
    # A tilt pushes: north by g phi_east, east by -g phi_north, with the tilt that the noise makes within the window.
    tilt = np.array([np.sum(sums[s:s + WINDOW] - sums[s], axis=0) + 0.5 * np.sum(turned[s:s + WINDOW], axis=0) for s in starts])
    force = np.array([np.sum(pushed[s:s + WINDOW], axis=0) for s in starts])
    regressor = force[:, :2] + GRAVITY * np.stack([tilt[:, 1], -tilt[:, 0]], axis=1)
    expected = GRAVITY * WINDOW * np.stack([phi[starts][:, 1], -phi[starts][:, 0]], axis=1)
    return attitude, slope(velocity[ends] - velocity[starts] - expected, regressor, starts)


def main():
    folder = Path(sys.argv[1])
    wrong = 0
    for seed in (1, 2, 3):
        file = folder / f"{seed}.csv"
        command = ["cargo", "run", "--quiet", "--release", "-p", "octant-followed", "--example", "power", "--"]
        command += ["--export", str(file), str(seed)]
        found = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout)
        for name, (value, sigma) in zip(("attitude", "velocity"), computed(file)):
            there = found[name]
            off = abs(value - there["slope"])
            agrees = off < 4 * np.hypot(sigma, there["sigma"]) and abs(value - 1) < 0.02 and sigma < 0.01
            wrong += not agrees
            print(f"seed {seed}, {name}: numpy {value:.5f} ± {sigma:.5f}, scored {there['slope']:.5f} ± {there['sigma']:.5f}",
                  "" if agrees else "WRONG")
    print("slopes on the noise: numpy and the scoring", "disagree" if wrong else "agree")
    sys.exit(1 if wrong else 0)


main()
