"""Writes wiring.h for platforms.c: tokens, outputs and connections of the plant and the calibrator (FMI 3.0).

Usage: platforms.py PLANT.fmu CALIBRATOR.fmu >wiring.h
"""

import sys
import zipfile
from xml.etree import ElementTree

TYPES = {"Float64": "F", "Int32": "I", "UInt64": "U", "Boolean": "B", "Enumeration": "E"}


def description(path):
    """Token, and variables by name and causality as (type, reference, elements)."""
    root = ElementTree.fromstring(zipfile.ZipFile(path).read("modelDescription.xml"))
    found = {"input": {}, "output": {}}
    for variable in root.find("ModelVariables"):
        if variable.get("causality") in found:
            count = 1
            for dimension in variable.findall("Dimension"):
                count *= int(dimension.get("start"))
            entry = (TYPES[variable.tag], int(variable.get("valueReference")), count)
            found[variable.get("causality")][variable.get("name")] = entry
    return root.get("instantiationToken"), found


def c(variable):
    return "{'%s', %d, %d}" % variable


def array(kind, name, items):
    print(f"static const struct {kind} {name}[] = {{{', '.join(items)}}};")


def wires(name, outputs, inputs):
    """Outputs to the inputs of the same names."""
    pairs = [(outputs[key], inputs[key]) for key in outputs if key in inputs]
    assert pairs and all(one[0] == other[0] and one[2] == other[2] for one, other in pairs), name
    array("wire", name, [f"{{{c(one)}, {other[1]}}}" for one, other in pairs])


(plant_token, plant), (core_token, core) = map(description, sys.argv[1:3])
print(f'static const char PLANT_TOKEN[] = "{plant_token}", CALIBRATOR_TOKEN[] = "{core_token}";')
array("variable", "PLANT_OUTPUTS", map(c, plant["output"].values()))
array("variable", "CALIBRATOR_OUTPUTS", map(c, core["output"].values()))
wires("TO_CALIBRATOR", plant["output"], core["input"])
wires("TO_PLANT", core["output"], plant["input"])
print(f"static const struct variable NAVIGATION_LATITUDE = {c(core['output']['navigation.latitude'])};")
