"""Variables of our FMUs by name, grouped by the function that sets or gets them."""

import csv
import ctypes

import numpy as np

# Type of a group of variables: what FMI 2.0 and FMI 3.0 call it in their functions, and in memory.
KINDS = {
    "Real": np.float64, "Integer": np.int32, "Boolean": np.int32,
    "Float64": np.float64, "Int32": np.int32, "UInt64": np.uint64, "Int64": np.int64,
    "Bool": np.uint8,
}


def kind_of(description, variable):
    """The suffix of the set and get functions."""
    if description.fmiVersion == "2.0":
        return variable.type
    return {"Enumeration": "Int64", "Boolean": "Bool"}.get(variable.type, variable.type)


class Group:
    """Variables of one type, with the values of all steps one row after another."""

    def __init__(self, kind):
        self.kind = kind
        self.references = []
        self.names = []
        self.columns = []

    def add(self, name, reference, column):
        self.references.append(reference)
        self.names.append(name)
        self.columns.append(np.reshape(column, (len(column), -1)))

    def finish(self):
        self.values = np.ascontiguousarray(
            np.hstack([column.astype(KINDS[self.kind]) for column in self.columns]))
        self.width = self.values.shape[1]
        self.reference_array = (ctypes.c_uint32 * len(self.references))(*self.references)
        self.pointer_type = ctypes.POINTER(np.ctypeslib.as_ctypes_type(KINDS[self.kind]))
        self.labels = [f"{name}[{i + 1}]" if column.shape[1] > 1 else name
                       for name, column in zip(self.names, self.columns)
                       for i in range(column.shape[1])]
        return self

    def row(self, index):
        """Pointer to a row."""
        return self.values[index].ctypes.data_as(self.pointer_type)


def grouped(description, columns):
    """Columns (name to array of rows) as groups: scalars in FMI 2.0, arrays in FMI 3.0."""
    by_name = {variable.name: variable for variable in description.modelVariables}
    groups = {}
    for name, column in columns.items():
        column = np.reshape(column, (len(column), -1))
        if name in by_name:
            parts = [(by_name[name], column)]
        else:
            parts = [(by_name[f"{name}[{i + 1}]"], column[:, i]) for i in range(column.shape[1])]
        for variable, part in parts:
            kind = kind_of(description, variable)
            group = groups.setdefault(kind, Group(kind))
            group.add(variable.name, variable.valueReference, part)
    return [group.finish() for group in groups.values()]


def parameters(path):
    """Parameter values of a scenario as `octant fmu build --scenario` writes them: FMI 3.0 name to
    values, one row."""
    values = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            values.setdefault(row["fmi3"], []).append(float(row["value"]))
    return {name: np.array([row]) for name, row in values.items()}


def bits(values):
    """The bits of numbers, to be compared and printed."""
    values = np.ascontiguousarray(values)
    return values.view(np.uint64) if values.dtype == np.float64 else values


def differences(label, expected, found, rows):
    """Compares two columns bit for bit; prints the first difference. True if there is one."""
    expected, found = bits(expected), bits(found)
    unequal = np.flatnonzero(expected != found)
    if len(unequal) == 0:
        return False
    at = unequal[0]
    row = rows[at]
    print(f"  {label}: {len(unequal)} of {len(expected)} differ, first in step {row}: "
          f"expected {int(expected[at]):#x}, found {int(found[at]):#x}")
    return True


def is_estimate(name):
    """Whether it is an estimated parameter or its σ."""
    return name.startswith(("parameters.", "sigma.")) and not name.endswith("revision")


def compare(wanted, found, rows, known):
    """Compares groups in these rows; estimates and their σ in those where they are known. True if
    there is a difference."""
    failed = False
    for want, got in zip(wanted, found):
        for at, label in enumerate(want.labels):
            these = rows[known[rows]] if is_estimate(label) else rows
            failed |= differences(label, want.values[these, at], got.values[these, at], these)
    return failed
