"""Rewrites source text so that it has many mutants at once, each of them off until the environment names it."""

import dataclasses

import tree_sitter
import tree_sitter_rust

PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_rust.language()))
OPERATION = {"binary_expression", "compound_assignment_expr"}


@dataclasses.dataclass
class Place:
    """Bytes of the source with what stands there in the mutants, or what is inserted at them."""

    start: int
    end: int
    # With each number the whole text; inserted text where nothing is replaced.
    texts: list


@dataclasses.dataclass
class Region:
    """Bytes of the rewritten text that belong to mutants: one of its own text, or all of a place."""

    start: int
    end: int
    numbers: list


def offset(source, lines, at):
    """Byte of a line and a column in characters, both from one."""
    begin, end = lines[at["line"] - 1], lines[at["line"]] if at["line"] < len(lines) else len(source)
    return begin + len(source[begin:end].decode()[: at["column"] - 1].encode())


def line_starts(source):
    return [0] + [index + 1 for index, byte in enumerate(source) if byte == 0x0A]


def span_of(source, mutant):
    lines = line_starts(source)
    return offset(source, lines, mutant["span"]["start"]), offset(source, lines, mutant["span"]["end"])


def plain(source, mutant):
    """The text with one mutant in place of the original, as cargo-mutants writes it."""
    start, end = span_of(source, mutant)
    return source[:start] + mutant["replacement"].encode() + source[end:]


def enclosing(node, kinds):
    while node is not None and node.type not in kinds:
        node = node.parent
    return node


def place_of(tree, source, number, mutant):
    """Where a mutant is switched; None where it can't be written as an expression of its own."""
    start, end = span_of(source, mutant)
    text = mutant["replacement"].encode()
    on = b"crate::mutant::on(%d)" % number
    genre = mutant["genre"]
    found = tree.root_node.descendant_for_byte_range(start, end)
    if genre == "FnValue":
        return Place(start, start, [(number, b"if %s { return %s; } " % (on, text))])
    if genre == "MatchArm":
        arm = enclosing(found, {"match_arm"})
        pattern = arm and arm.child_by_field_name("pattern")
        if pattern is None or arm.start_byte > start or pattern.child_by_field_name("condition"):
            return None
        return Place(pattern.end_byte, pattern.end_byte, [(number, b" if !%s" % on)])
    if genre == "MatchArmGuard":
        return Place(start, end, [(number, text)])
    if genre == "StructField":
        whole = enclosing(found, {"struct_expression"})
    elif genre == "UnaryOperator":
        whole = enclosing(found, {"unary_expression", "negative_literal"})
    elif genre == "BinaryOperator":
        whole = found.parent
        if whole.type not in OPERATION:
            return None
        # The text of a mutant is read with the precedence of its own operator: all of the chain is in it.
        while whole.parent.type in OPERATION and whole.type == "binary_expression":
            if whole.parent.type == "compound_assignment_expr":
                break
            whole = whole.parent
    else:
        return None
    if whole is None:
        return None
    mutated = source[whole.start_byte : start] + text + source[end : whole.end_byte]
    return Place(whole.start_byte, whole.end_byte, [(number, mutated)])


def merged(places):
    """Places in the order of the text, those of the same bytes as one; what contains others comes first."""
    found = {}
    for place in places:
        found.setdefault((place.start, place.end), Place(place.start, place.end, [])).texts.extend(place.texts)
    return sorted(found.values(), key=lambda place: (place.start, place.end != place.start, -place.end))


def rewritten(source, numbered):
    """Rewritten text, its regions, and the numbers of those that can't be switched."""
    tree = PARSER.parse(source)
    places, impossible = [], []
    for number, mutant in numbered:
        place = place_of(tree, source, number, mutant)
        if place is None:
            impossible.append(number)
        else:
            places.append(place)
    out, regions = bytearray(), []
    write(out, regions, source, 0, len(source), merged(places))
    return bytes(out), regions, impossible


def write(out, regions, source, start, end, places):
    """Writes the bytes from start to end with their places; each mutant has the original text around it."""
    at = start
    while places:
        place = places.pop(0)
        inside = []
        while places and place.end > place.start and places[0].start < place.end:
            inside.append(places.pop(0))
        out += source[at : place.start]
        whole = len(out)
        if place.start == place.end:
            for number, text in place.texts:
                begin = len(out)
                out += text
                regions.append(Region(begin, len(out), [number]))
        else:
            out += b"("
            for number, text in place.texts:
                out += b"if crate::mutant::on(%d) { " % number
                begin = len(out)
                out += text
                regions.append(Region(begin, len(out), [number]))
                out += b" } else "
            out += b"{ "
            write(out, regions, source, place.start, place.end, inside)
            out += b" })"
        regions.append(Region(whole, len(out), [number for number, _ in place.texts]))
        at = place.end
    out += source[at:end]


def blamed(regions, spans, text):
    """Numbers of the mutants that an error of the compiler is about: the smallest region around one of its spans, or
    those inside of it, or those of the function."""
    for start, end in spans:
        around = [region for region in regions if region.start <= start and end <= region.end]
        if around:
            return min(around, key=lambda region: region.end - region.start).numbers
    for start, end in spans:
        touched = [region for region in regions if region.start < end and start < region.end]
        if touched:
            return sorted({number for region in touched for number in region.numbers})
    tree = PARSER.parse(text)
    for start, end in spans:
        function = enclosing(tree.root_node.descendant_for_byte_range(start, end), {"function_item"})
        inside = [region for region in regions if function and function.start_byte <= region.start < function.end_byte]
        if inside:
            return sorted({number for region in inside for number in region.numbers})
    return []
