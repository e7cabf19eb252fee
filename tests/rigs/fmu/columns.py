#!/usr/bin/env python3
"""Inputs and outputs of the core from a full-rate recording, as COLUMNS.npz.

Usage: columns.py RECORDING COLUMNS.npz
"""

import sys

import numpy as np

import recording

messages = recording.read(sys.argv[1])
outputs, _ = recording.outputs(messages)
# Rows in which the file has the parameters themselves.
rows = np.isin(messages["/output"]["sequence"], messages["/parameters"]["sequence"])
np.savez(sys.argv[2], **{"in " + name: column for name, column in recording.inputs(messages).items()},
         **{"out " + name: column for name, column in outputs.items()},
         **{"parameter rows": rows})
print(f"{len(rows)} samples, parameters in {rows.sum()} of them")
