"""Project of sphinx-needs with Octant's fields, for tests/rigs/requirements."""

import json
import pathlib

# The types of the extra fields and of the links are those of the file that is imported.
file = json.loads(pathlib.Path("ours.json").read_text(encoding="utf-8"))
schema = file["versions"][file["current_version"]]["needs_schema"]["properties"]

project = file["project"]
version = file["current_version"]
extensions = ["sphinx_needs"]
needs_id_regex = "^[A-Za-z0-9_.-]+$"
needs_reproducible_json = True
needs_types = [
    {"directive": kind, "title": kind, "prefix": "", "color": "#fff", "style": "node"}
    for kind in ("req", "SYSTEM_REQUIREMENT")
]
needs_fields = {
    name: {"schema": {key: value for key, value in of.items() if key != "field_type"}, "nullable": True}
    for name, of in schema.items()
    if of["field_type"] == "extra"
}
for of in needs_fields.values():
    if isinstance(of["schema"]["type"], list):
        of["schema"]["type"] = of["schema"]["type"][0]
needs_links = {
    name: {"incoming": f"is the target of {name}", "outgoing": name}
    for name, of in schema.items()
    if of["field_type"] == "links" and name not in ("links", "parent_needs")
}
