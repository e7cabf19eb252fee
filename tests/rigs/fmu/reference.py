#!/usr/bin/env python3
"""Compares a tool's result with a reference result, bit for bit.

Usage: reference.py RESULT.csv REFERENCE.csv
"""

import csv
import struct
import sys


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], [[float(cell.replace("True", "1").replace("False", "0")) for cell in row]
                     for row in rows[1:]]


def bits(value):
    return struct.pack("<d", value) if value == value else "no number"


names, rows = read(sys.argv[1])
wanted, reference = read(sys.argv[2])
by_step = {round(row[0] / 0.005): row for row in rows}
for row in reference:
    found = by_step.get(round(row[0] / 0.005))
    if found is None:
        sys.exit(f"{sys.argv[1]} has no row at {row[0]} s")
    for name, value in list(zip(wanted, row))[1:]:
        other = found[names.index(name)]
        if bits(other) != bits(value):
            sys.exit(f"{name} at {row[0]} s is {other!r}, the reference says {value!r}")
print(f"ok   {sys.argv[2].split('/')[-1]}: {len(reference)} rows of {len(wanted) - 1} outputs equal "
      "bit for bit")
