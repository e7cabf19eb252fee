// Markers of the run on every plot over time: stops, moves, faults, reports of the core. The page's data
// block has their times in hours of the run: [start, end, label].

const marks = {
  kinds: { moves: [], stops: [], faults: [], noticed: [] },
  names: { moves: "Moves", stops: "Stops", faults: "Faults", noticed: "Noticed" },
  shown: { moves: true, stops: false, faults: true, noticed: true },
};

function loadMarks() {
  const block = document.getElementById("marks");
  if (block) Object.assign(marks.kinds, JSON.parse(block.textContent));
}

// Draws the markers of a plot. Kinds with more markers than the drawing can tell apart are left out.
function drawMarks(plot) {
  const { offset } = plot.data, parts = [];
  if (offset === null) return;
  const inside = (kind) => marks.shown[kind]
    ? marks.kinds[kind].filter(([start, end]) => end - offset >= plot.x[0] && start - offset <= plot.x[1])
    : [];
  const most = (plot.right - plot.left) / 7;
  const at = (hours) => px(plot.toPx(Math.max(plot.x[0], Math.min(plot.x[1], hours - offset))));
  const titled = (made, text) => {
    made.append(element("title", {}, text));
    parts.push(made);
  };
  const moves = inside("moves");
  if (moves.length < most) for (const [start, end] of moves) {
    const from = at(start);
    parts.push(element("rect", { class: "move", x: from, y: plot.top, width: Math.max(1, at(end) - from), height: plot.bottom - plot.top }));
  }
  const stops = inside("stops");
  if (stops.length < most) for (const [start, end, label] of stops) {
    const from = at(start), to = at(end);
    parts.push(element("path", { class: "stop", d: `M${from} ${plot.bottom}v-6` }));
    // Where the position has no room, the number stands alone.
    const text = [label, label.split(" ")[0]].find((text) => to - from > 6.4 * text.length);
    if (text) titled(element("text", { class: "tick x", x: (from + to) / 2, y: plot.bottom - 4 }, text), `stop ${label}`);
  }
  let last = -Infinity;
  for (const [start, end, label] of inside("faults")) {
    const from = at(start), to = at(end);
    if (to > from + 1) parts.push(element("rect", { class: "fault", x: from, y: plot.top, width: to - from, height: plot.bottom - plot.top }));
    titled(element("path", { class: "fault", d: `M${from} ${plot.top}V${plot.bottom}` }), label);
    if (from > last + 90) {
      parts.push(element("text", { class: "note start fault", x: from + 4, y: plot.top + (plot.data.bracket ? 24 : 9) }, label));
      last = from;
    }
  }
  last = -Infinity;
  for (const [start, , label] of inside("noticed")) {
    const from = at(start);
    if (from < last + 3) continue;
    last = from;
    titled(element("path", { class: "noticed", d: `M${from} ${plot.top}V${plot.bottom}M${from - 4} ${plot.bottom + 6}h8l-4 -7z` }), label);
  }
  plot.layers.marks.replaceChildren(...parts);
}

// Switches of the kinds that the run has; `redraw` draws the plots again.
function markSwitches(redraw) {
  return Object.keys(marks.kinds).filter((kind) => marks.kinds[kind].length > 0).map((kind) => {
    const label = document.createElement("label");
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = marks.shown[kind];
    box.dataset.kind = kind;
    box.addEventListener("change", () => {
      marks.shown[kind] = box.checked;
      redraw();
    });
    label.className = `switch ${kind}`;
    label.append(box, `${marks.names[kind]} `);
    const count = document.createElement("span");
    count.textContent = marks.kinds[kind].length;
    label.append(count);
    return label;
  });
}
