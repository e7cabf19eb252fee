#!/usr/bin/env python3
"""Copies FMI 3.0 FMUs without what version 0.8.0 of the `fmi` crate can't read.

Usage: known_to_fmi_crate.py FOLDER FMU...

The crate refuses the whole description for the nominal value of a variable, and for the exponent of
the kelvin in a unit (it expects it written as "k"), both of which the standard has. Everything else
in the copy is as it was.
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
                data, nominals = re.subn(rb' nominal="[^"]*"', b"", data)
                data, kelvins = re.subn(rb' K="-?[0-9]+"', b"", data)
                print(f"     {path.name}: {nominals} nominal values and {kelvins} kelvins left out")
            copy.writestr(name, data)
