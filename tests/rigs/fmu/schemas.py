#!/usr/bin/env python3
"""Checks what the tools leave unchecked against the schemas of FMI and SSP that FMPy ships.

Usage: schemas.py FOLDER
"""

import io
import pathlib
import sys
import zipfile

import fmpy
from fmpy.ssp.ssd import read_ssd
from lxml import etree

SCHEMAS = pathlib.Path(fmpy.__file__).parent


def schema(path):
    return etree.XMLSchema(etree.parse(str(SCHEMAS / path)))


def main():
    folder = pathlib.Path(sys.argv[1])
    ssp = "ssp/schema/SystemStructure"
    checks = {"terminalsAndIcons/terminalsAndIcons.xml": "schema/fmi3/fmi3TerminalsAndIcons.xsd",
              "SystemStructure.ssd": f"{ssp}Description.xsd"}
    checked = 0
    failed = False
    for path in sorted([*folder.glob("*.fmu"), *folder.glob("*.ssp")]):
        with zipfile.ZipFile(path) as archive:
            for name in archive.namelist():
                against = checks.get(name)
                if name.endswith(".ssv"):
                    against = f"{ssp}ParameterValues.xsd"
                if against is None:
                    continue
                validator = schema(against)
                good = validator.validate(etree.parse(io.BytesIO(archive.read(name))))
                print(f"{'ok  ' if good else 'FAIL'} {path.name} {name} against its schema")
                for entry in validator.error_log:
                    print(f"     line {entry.line}: {entry.message}")
                checked += 1
                failed |= not good
    for path in folder.glob("*.ssp"):
        structure = read_ssd(str(path))
        names = [element.name for element in structure.system.elements]
        print(f"ok   {path.name} read by FMPy: {', '.join(names)}, "
              f"{len(structure.system.connections)} connections")
        failed |= len(names) != 2
    return failed or checked < 5


if __name__ == "__main__":
    sys.exit(main())
