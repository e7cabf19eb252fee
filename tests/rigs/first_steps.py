"""Does the first steps of docs/python.md in this folder, and holds that the requirement passes and then fails."""

import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("agg")

text = Path(sys.argv[1]).read_text(encoding="utf-8")
section = re.search(r"^## From `pip install`.*?(?=^## )", text, re.M | re.S)[0]
names = {}
for block in re.findall(r"^```python\n(.*?)^```", section, re.M | re.S):
    exec(compile(block, "docs/python.md", "exec"), names)
run, failed = names["run"], names["failed"]
assert run.verdict == "pass", (run.verdict, run.requirements)
assert failed.verdict == "fail", (failed.verdict, failed.requirements)
assert failed.requirements[0]["verdict"] == "fail", failed.requirements
assert Path("runs/jump/report.html").is_file()
