"""Reference pages, made from what the program says: keys, commands, measures, faults.

Each page asks the program itself, so that none can be older than it:

- keys: the JSON Schema that `octant schema` prints;
- commands: `--help` of every command;
- measures: the list that `octant requirements measures --json` prints;
- faults: the list that `octant faults list --json` prints.

An answer of another form than expected ends the build.
"""

import html
import json
import pathlib
import re
import subprocess


class AnswerError(Exception):
    """The program answered in a form from which no page can be made."""


class Program:
    """The program, called by the name that its users know."""

    def __init__(self, path):
        self.path = str(pathlib.Path(path).resolve())

    def run(self, *arguments, folder=None):
        """Exit status, stdout and stderr."""
        # Help texts as wide as a page, without colours.
        environment = {"PATH": "/usr/bin:/bin", "NO_COLOR": "1", "COLUMNS": "88"}
        done = subprocess.run(["octant", *arguments], executable=self.path, cwd=folder, env=environment,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)
        return done.returncode, done.stdout, done.stderr

    def ask(self, *arguments):
        """Stdout of a command that has to succeed."""
        status, out, err = self.run(*arguments)
        if status != 0:
            raise AnswerError(f"octant {' '.join(arguments)}: exit status {status}: {err.strip()}")
        return out

    def version(self):
        return self.ask("--version").split()[-1]


def write(folder, program):
    """Writes all reference pages into `folder`, and returns the kinds of faults."""
    folder.mkdir(parents=True, exist_ok=True)
    kinds = json.loads(program.ask("faults", "list", "--json"))["kinds"]
    version = program.version()
    pages = {
        "keys.md": keys(json.loads(program.ask("schema")), kinds),
        "commands.md": commands(program),
        "measures.md": measures(json.loads(program.ask("requirements", "measures", "--json"))),
        "faults.md": faults(kinds),
    }
    for name, text in pages.items():
        note = f"\n\n---\n\nMade from the program itself, version {version}.\n"
        (folder / name).write_text(text.rstrip("\n") + note, encoding="utf-8")
    return kinds


def cell(text):
    """Text of a table's cell: a pipe ends no cell, and nothing in it is markup."""
    text = re.sub(r"\s*\n\s*", " ", text.strip())
    # What stands in backticks already stays as it is.
    parts = text.split("`")
    for at in range(0, len(parts), 2):
        parts[at] = re.sub(r"([\\*_<\[\]|])", r"\\\1", parts[at])
        parts[at] = re.sub(r'"([^"]*)"', lambda found: code(found[0].replace("\\", "")), parts[at])
    return "`".join(parts)


def code(text):
    """Text as code, in a cell too."""
    if "|" not in text and "`" not in text:
        return f"`{text}`"
    return f"<code>{html.escape(text, quote=False).replace('|', '&#124;').replace('`', '&#96;')}</code>"


def named(anchor, text):
    """A name as code with an anchor, which may break after a dot or before an underscore."""
    broken = text.replace(".", ".<wbr>").replace("_", "<wbr>_")
    return f'<code id="{anchor}">{broken}</code>'


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n\n"


# --- keys -------------------------------------------------------------------------------------------------

def keys(schema, kinds):
    """Every key of a scenario, a table for each table of the file."""
    own = {kind["name"]: {parameter["name"] for parameter in kind["parameters"]} for kind in kinds}
    count = 0
    sections = []
    top = []
    for name, node in sorted(schema["properties"].items()):
        if name == "faults":
            node = dict(node, items=fault_keys(node["items"]["oneOf"], own))
        inner = children(node)
        if not inner:
            top.append((name, dict(node, given="always given" if name in schema.get("required", []) else "")))
            count += 1
            continue
        rows = []
        collect(name, inner, rows)
        count += sum(len(found) for _, found in rows)
        sections.append((name, node, rows))
    text = (f"# Keys\n\nAll {count} keys of a scenario. Quantities are texts with a unit, such as `\"12 h\"`: "
            "[units](../docs/scenario.md#quantities). A key of a table `[a.b]` is written `a.b.key` after `--set`. Keys of "
            "other files: [campaigns](../docs/campaigns.md#the-file), [requirements](../docs/requirements.md#the-file).\n\n")
    text += "## Outside of tables\n\n" + key_table("", top)
    for name, node, rows in sections:
        about, takes, left_out = description(node)
        brackets = f"[[{name}]]" if node.get("type") == "array" else f"[{name}]"
        text += f"## {name}\n\n`{brackets}`: {cell(about)}{default_words(node, left_out)}\n\n"
        if name == "faults":
            text += "The parameters of each kind are in [faults](faults.md).\n\n"
        for path, found in rows:
            if path != name:
                text += f"### {path}\n\n"
            text += key_table(path + ".", found)
    return text


def default_words(node, left_out):
    return f" Left out: {cell(left_out)}" if left_out else ""


def fault_keys(branches, own):
    """The keys that faults of several kinds have; those of one kind are its parameters."""
    common, required = {}, set()
    for branch in branches:
        (kind,) = branch["properties"]["kind"]["enum"]
        for key, node in branch["properties"].items():
            if key not in own[kind]:
                common.setdefault(key, node)
                required.update({key} & set(branch.get("required", [])))
    about, _, _ = description(common["kind"])
    common["kind"] = {"description": f"{about} Takes the name of a kind."}
    return {"properties": common, "required": sorted(required)}


def children(node):
    """The described keys of the table, or of the tables, that a key takes; of tables to choose from, those of all."""
    found = {}
    choices = [children(one) for key in ("anyOf", "oneOf") for one in node.get(key, [])]
    alone = sum(bool(choice) for choice in choices) == 1
    for choice in choices:
        for key, inner in choice.items():
            given = inner["given"] if alone or not inner["given"] else "another is given"
            found[key] = dict(inner, given=given)
    if "items" in node:
        found.update(children(node["items"]))
    for key, inner in node.get("properties", {}).items():
        if "description" in inner:
            found[key] = dict(inner, given="always given" if key in node.get("required", []) else "")
    return found


def collect(path, inner, rows):
    """Appends a table of keys, then those inside of it, in the order of the alphabet."""
    rows.append((path, sorted(inner.items())))
    for key, node in sorted(inner.items()):
        deeper = children(node)
        if deeper:
            collect(f"{path}.{key}", deeper, rows)


def description(node):
    """The three parts of a description: meaning, what it takes, what stands where it is left out."""
    if "description" not in node:
        raise AnswerError(f"a key without a description: {json.dumps(node)[:200]}")
    text = node["description"]
    about, has, rest = text.partition(" Takes ")
    if not has:
        raise AnswerError(f"a description without \"Takes\": {text}")
    takes, has, left_out = re.match(r"(.*?)(?: (Left out|Default): (.*))?$", rest, re.S).groups()
    return about, takes.rstrip("."), left_out if has else ""


def key_table(prefix, found):
    rows = []
    for key, node in found:
        about, takes, left_out = description(node)
        if "default" in node:
            value = node["default"]
            left_out = code(json.dumps(value, ensure_ascii=False))
        elif left_out:
            left_out = cell(left_out.rstrip("."))
        elif node["given"]:
            left_out = node["given"]
        else:
            left_out = "the defaults of its keys" if children(node) else ""
        rows.append([named(prefix + key, key), cell(about), cell(takes), left_out])
    return table(["key", "meaning", "takes", "left out"], rows)


# --- commands ---------------------------------------------------------------------------------------------

def commands(program):
    """The help of every command, and of those inside of it."""
    text = ("# Commands and options\n\nThe help texts of all commands. What they print, with examples and exit statuses: "
            "[commands](../docs/commands.md).\n\n")
    waiting = [()]
    count = 0
    while waiting:
        words = waiting.pop(0)
        help_text = program.ask(*words, "--help").rstrip()
        inner = [(*words, name) for name in subcommands(help_text)]
        waiting = inner + waiting
        count += 1
        level = "##" if len(words) < 2 else "###"
        text += f"{level} {' '.join(('octant', *words))}\n\n```text\n{help_text}\n```\n\n"
    if count < 10:
        raise AnswerError(f"the help names {count} commands, expected many")
    return text


def subcommands(help_text):
    """Names in the section `Commands:` of a help text."""
    section = re.search(r"^Commands:\n((?:  .*\n)+)", help_text + "\n", re.M)
    found = re.findall(r"^  (\S+)", section[1], re.M) if section else []
    return [name for name in found if name != "help"]


# --- measures ---------------------------------------------------------------------------------------------

OF_PARAMETER = "the unit of the parameter"
MEASURES_FORM = 1


def unit_words(unit):
    if unit == OF_PARAMETER:
        return unit
    return "a plain number" if unit == "1" else code(unit)


def measures(listed):
    """Every measure by table; tables of parameters, which are all alike, become one."""
    if listed["schema"] != MEASURES_FORM or len(listed["measures"]) < 100:
        raise AnswerError(f"found {len(listed['measures'])} measures of form {listed['schema']}, expected many of {MEASURES_FORM}")
    units = {entry["measure"]: entry["unit"] for entry in listed["measures"]}
    groups, parameters = {}, {}
    for entry in listed["measures"]:
        path, unit, about = entry["measure"], entry["unit"], entry["meaning"]
        if path.startswith("baseline."):
            if units.get(path.removeprefix("baseline.")) != unit:
                raise AnswerError(f"{path} has no counterpart in the first method")
            continue
        parts = path.split(".")
        if path.startswith("calibration.parameters.") and parts[3] == "error":
            parameters.setdefault(unit, []).append(parts[2])
        if len(parts) > 3 and parts[1] == "parameters":
            about = about.replace(f": {parts[2]}: ", ": ")
            path, unit = ".".join([*parts[:2], "NAME", *parts[3:]]), OF_PARAMETER if unit != "1" else unit
        sign = "±" if entry["signed"] else ""
        needs = ", ".join(code(need) for need in entry["needs"] if need != "baseline")
        groups.setdefault(path.split(".")[0], {})[path] = [unit_words(unit), sign, cell(about.partition(": ")[2] or about), needs]
    text = (f"# Measures\n\nAll {len(units)} numbers that a [requirement](../docs/requirements.md#measures) of a scenario, a "
            "campaign or a file of requirements can limit: paths into "
            "[`summary.json`](../docs/results.md#summaryjson-schema-3). A limit is a plain number, or a quantity where the table "
            "names a unit; a plain number is in that unit. A measure with ± can be negative: bars about it take its "
            'magnitude, `"|calibration.parameters.g_zz.error|"`. A run has a measure if it has what the last column names.\n\n')
    for top, found in groups.items():
        text += f"## {top}\n\n"
        text += table(["measure", "a limit is in", "sign", "meaning", "needs"],
                      # A measure without a table has the anchor of its heading.
                      [[code(place) if place == top else named(place, place), *row] for place, row in found.items()])
    text += "## Names of parameters\n\nEach takes the place of `NAME`.\n\n"
    text += table(["unit", "parameters"],
                  [[code(unit), ", ".join(code(name) for name in names)] for unit, names in parameters.items()])
    text += "## Needs\n\n"
    text += table(["name", "what it is"], [[code(name), cell(about)] for name, about in listed["needs"].items()])
    second = dict.fromkeys(path.split(".")[1] for path in units if path.startswith("baseline."))
    text += ("## baseline\n\nThe second method has the measures of " + ", ".join(code(name) for name in second)
             + " too, such as `baseline.navigation.longitude_error_arcmin.max`.\n")
    return text


# --- faults -----------------------------------------------------------------------------------------------

LASTS = {"span": "for its duration", "fading": "for its duration, then it can fade", "instant": "an instant"}


def families(kinds):
    """Kinds by family, in the order of the program."""
    found = {}
    for kind in kinds:
        found.setdefault(kind["family"], []).append(kind)
    return found


def faults(kinds):
    """Every kind of fault with its parameters."""
    text = (f"# Kinds of faults\n\nAll {len(kinds)} kinds. How a fault is written, when it sets in and how its effect is found: "
            "[faults](../docs/faults.md).\n\n")
    for family, members in families(kinds).items():
        text += f"## {family[0].upper()}{family[1:]}\n\n"
        for kind in members:
            text += fault(kind)
    return text


def fault(kind):
    name = kind["name"]
    page = pathlib.Path(__file__).parent.parent / "faults" / f"{name}.md"
    more = f" [Model, example and picture](../docs/faults/{name}.md)." if page.exists() else ""
    if kind["lasts"] not in LASTS:
        raise AnswerError(f"the fault {name} lasts {kind['lasts']!r}, expected one of {', '.join(LASTS)}")
    text = f"### {name}\n\n{cell(kind['summary'])} Acts {kind['acts']}; lasts {LASTS[kind['lasts']]}.{more}\n\n"
    rows = [[code(parameter["name"]), cell(parameter["doc"]), cell(parameter["takes"]),
             "always given" if parameter["default"] is None else code(parameter["default"])]
            for parameter in kind["parameters"]]
    return text + (table(["parameter", "meaning", "takes", "default"], rows) if rows else "No parameters.\n\n")
