#!/usr/bin/env python3
"""Copies FMI 3.0 FMUs without the nominal values of their variables.

Usage: without_nominal.py FOLDER FMU...

Version 0.8.0 of the `fmi` crate knows no such attribute, which the standard has, and refuses the
whole description. Everything else in the copy is as it was.
"""

import pathlib
import re
import sys
import zipfile

for path in map(pathlib.Path, sys.argv[2:]):
    with zipfile.ZipFile(path) as source, \
            zipfile.ZipFile(pathlib.Path(sys.argv[1], path.name), "w") as copy:
        for name in source.namelist():
            data = source.read(name)
            if name == "modelDescription.xml":
                data, count = re.subn(rb' nominal="[^"]*"', b"", data)
                print(f"     {path.name}: {count} nominal values left out")
            copy.writestr(name, data)
