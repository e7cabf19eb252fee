"""Compares our needs.json with what sphinx-needs wrote after it imported it: each field of each need."""

import json
import sys


def needs(path):
    with open(path, encoding="utf-8") as file:
        content = json.load(file)
    return content["versions"][content["current_version"]]["needs"]


ours, theirs = needs(sys.argv[1]), needs(sys.argv[2])
assert list(ours) and sorted(ours) == sorted(theirs), (list(ours), list(theirs))
compared = 0
for name, need in ours.items():
    for field, value in need.items():
        # Sections are those of the page that imports.
        if field == "sections" or value in ("", []):
            continue
        found = theirs[name].get(field)
        assert found == value, f"{name}.{field}: {found!r} is not {value!r}"
        compared += 1
assert compared > 5 * len(ours), compared
print(f"{compared} fields of {len(ours)} needs are the same")
