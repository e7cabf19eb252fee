"""Floating-point constants of a program, by the functions that take them."""

import collections
import re
import struct
import subprocess

# Functions whose constants make numbers of a run or a report: models, draws, statistics, and of the harness what
# makes, scores and sums up. Where a mark of a picture stands, what a terminal shows and how a device is spoken to
# isn't a quantity.
OURS = re.compile(
    r"\boctant_(earth|random|sample|calibration|faults|plant|statistics|requirements|scenario|score)::"
    r"|\boctant_(observe|campaign|run)::|\boctant_nightly::compare"
)
PICTURES = re.compile(r"\boctant_campaign_pages::|\boctant_run::observers::gimbals::")
# What a conversion between integers and floating point needs on this processor: no number of ours.
IDIOMS = {2.0**51, 2.0**52, 2.0**84, 2.0**63, 2.0**64, 2.0**31, 2.0**32, 2.0**53, 2.0**63 - 1024, 2.0**64 - 2048,
          2.0**32 - 1, 2.0**31 - 1}
SCALAR = re.compile(r"^(v?)(mov|mul|add|sub|div|max|min|ucomi|comi|cmp\w*|movh|movl)(sd|pd)$")
PACKED = re.compile(r"^(mul|add|sub|div|max|min|mova|movu|cmp\w*)pd$")
MOVES = {"movaps", "movups", "movdqa", "movdqu"}


def sections(data):
    """Name, address, offset and size of each section."""
    (table,) = struct.unpack_from("<Q", data, 0x28)
    size, count, names = struct.unpack_from("<HHH", data, 0x3A)
    raw = [struct.unpack_from("<IIQQQQ", data, table + size * i) for i in range(count)]
    base = raw[names][4]
    found = {}
    for name, _, _, address, offset, length in raw:
        end = data.index(b"\0", base + name)
        found[data[base + name:end].decode()] = (address, offset, length)
    return found


def plausible(bits):
    """A number that somebody may have written; texts, addresses, masks and idioms aren't."""
    (value,) = struct.unpack("<d", bits)
    if value != value or not 1e-40 < abs(value) < 1e40 or abs(value) in IDIOMS:
        return None
    if all(0x20 <= byte < 0x7F for byte in bits):
        return None
    return value


def readable(symbol):
    """A symbol of Rust without its hash."""
    symbol = re.sub(r"(\.llvm\.\d+|\.cold.*)$", "", symbol)
    symbol = re.sub(r"::h[0-9a-f]{16}$", "", symbol)
    return symbol


def constants(program):
    """All constants: where they are, their value, who takes them, and the instructions that do."""
    data = program.read_bytes()
    known = sections(data)
    if ".symtab" not in known:
        raise SystemExit(f"{program} has no symbols, by which constants are told apart: build it with CARGO_PROFILE_RELEASE_STRIP=debuginfo")
    address, offset, length = known[".rodata"]
    text_address, text_offset, _ = known[".text"]
    listing = subprocess.Popen(
        ["objdump", "-d", "-C", "--no-show-raw-insn", "-M", "intel", "--section=.text", program],
        stdout=subprocess.PIPE, text=True,
    )
    sites = collections.defaultdict(lambda: {"sites": set(), "functions": set(), "offsets": set()})
    function, ours, immediates = "", False, []
    head = re.compile(r"^[0-9a-f]+ <(.*)>:$")
    from_data = re.compile(r"^\s*([0-9a-f]+):\s+(\S+)\s+(.*?)\s*# ([0-9a-f]+)")
    immediate = re.compile(r"^\s*([0-9a-f]+):\s+movabs\s+\w+,0x([0-9a-f]+)")
    for line in listing.stdout:
        begins = head.match(line)
        if begins:
            function = readable(begins[1])
            ours = bool(OURS.search(function)) and not PICTURES.search(function)
            continue
        if not ours:
            continue
        if "[rip" in line:
            found = from_data.match(line)
            if not found:
                continue
            site, target = int(found[1], 16), int(found[4], 16)
            operation, operands = found[2], found[3]
            if not address <= target < address + length - 15:
                continue
            if "QWORD PTR" in operands and (SCALAR.match(operation) or operation in ("movq", "movhps", "mov")):
                halves = [target]
            elif "XMMWORD PTR" in operands and (PACKED.match(operation) or operation in MOVES):
                halves = [target, target + 8]
            else:
                continue
            pairs = [plausible(data[h - address + offset:h - address + offset + 8]) for h in halves]
            integers = not (SCALAR.match(operation) or PACKED.match(operation))
            zero = [data[h - address + offset:h - address + offset + 8] in (bytes(8), bytes(7) + b"\x80") for h in halves]
            # A move that may be of text or integers counts where both halves are numbers.
            if integers and not all(p is not None or z for p, z in zip(pairs, zero)):
                continue
            for half, value in zip(halves, pairs):
                if value is not None:
                    entry = sites["data", half]
                    entry["offsets"].add(half - address + offset)
                    entry["value"] = value
                    entry["sites"].add(site)
                    entry["functions"].add(function)
        elif "movabs" in line:
            found = immediate.match(line)
            if not found:
                continue
            site, bits = int(found[1], 16), int(found[2], 16)
            value = plausible(struct.pack("<Q", bits))
            if value is not None:
                immediates.append((site, bits, function, value))
    listing.stdout.close()
    if listing.wait() != 0:
        raise SystemExit("objdump could not read the program")
    for site, bits, function, value in immediates:
        at = site - text_address + text_offset
        # REX.W, opcode, and the eight bytes of the number.
        assert data[at + 2:at + 10] == struct.pack("<Q", bits)
        entry = sites["immediate", function, bits]
        entry["offsets"].add(at + 2)
        entry["value"] = value
        entry["sites"].add(site)
        entry["functions"].add(function)
    return [
        {"kind": key[0], "value": entry["value"], "offsets": sorted(entry["offsets"]),
         "sites": sorted(entry["sites"]), "functions": sorted(entry["functions"])}
        for key, entry in sorted(sites.items(), key=lambda item: min(item[1]["offsets"]))
    ]


def copies(program, value):
    """Every place of this number: in read-only data, whoever reads it there (a table of units is read by its index), and in
    instructions that hold it."""
    data = program.read_bytes()
    bits = struct.pack("<d", value)
    found = []
    for name, (_, offset, length) in sections(data).items():
        if name not in (".rodata", ".data.rel.ro", ".text"):
            continue
        at = data.find(bits, offset, offset + length)
        while at != -1:
            # Data is aligned; REX.W and the opcode of a move stand before the number in an instruction.
            moves = data[at - 2] in (0x48, 0x49) and 0xB8 <= data[at - 1] <= 0xBF
            if moves if name == ".text" else at % 8 == 0:
                found.append({"kind": "copy", "value": value, "offsets": [at], "sites": [], "functions": [f"{name} at {at:#x}"]})
            at = data.find(bits, at + 1, offset + length)
    return found
