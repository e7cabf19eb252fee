// Plots together: one range and one cursor for all of them that are over the time of the run.

const linked = { plots: [], view: null, at: null, active: null, pending: false, drawMs: 0 };

// Plots that a plot shares its range and cursor with.
function group(plot) {
  return plot.data.offset === null ? [plot] : linked.plots.filter((other) => other.data && other.data.offset !== null);
}

// Draws the plots that are in sight in the next frame; the others when they come into sight.
function redraw() {
  if (linked.pending) return;
  linked.pending = true;
  requestAnimationFrame(() => {
    linked.pending = false;
    const start = performance.now();
    // All widths are read before anything is written: one layout for all plots.
    const due = linked.plots.filter((plot) => plot.dirty && plot.seen);
    for (const plot of due) plot.measured = plot.root.clientWidth;
    for (const plot of due) plot.draw();
    linked.drawMs = performance.now() - start;
    document.documentElement.dataset.drawMs = linked.drawMs.toFixed(1);
  });
}

function redrawAll() {
  for (const plot of linked.plots) plot.dirty = true;
  redraw();
}

// Shows a range of x of a plot, in all plots of its group; null: everything.
function show(plot, range) {
  if (range) {
    const [low, high] = plot.span, least = (high - low) * 1e-5;
    let [from, to] = range;
    if (to - from < least) return;
    const length = Math.min(to - from, high - low);
    from = Math.max(low, Math.min(from, high - length));
    to = from + length;
    range = length >= (high - low) * 0.9999 ? null : [from, to];
  }
  const { offset } = plot.data;
  if (offset === null) {
    plot.view = range;
    plot.dirty = true;
  } else {
    linked.view = range && range.map((x) => x + offset);
    for (const other of linked.plots) follow(other);
  }
  showRange();
  redraw();
}

// Gives a plot over time the range of the others.
function follow(plot) {
  if (!plot.data || plot.data.offset === null) return;
  plot.view = linked.view && linked.view.map((x) => x - plot.data.offset);
  plot.dirty = true;
}

function reset() {
  linked.view = null;
  for (const plot of linked.plots) plot.view = null;
  showRange();
  redrawAll();
}

function zoom(plot, factor, around) {
  const [low, high] = plot.range(), at = around ?? (low + high) / 2;
  show(plot, [at - (at - low) * factor, at + (high - at) * factor]);
}

function pan(plot, part) {
  const [low, high] = plot.range(), by = part * (high - low);
  if (plot.isZoomed()) show(plot, [low + by, high + by]);
}

function moveCursors(plot, x) {
  linked.active = plot;
  for (const other of group(plot)) {
    const at = x === null || plot.data.offset === null ? x : x + plot.data.offset - other.data.offset;
    if (other.seen) other.moveCursor(at);
    else other.at = at;
  }
}

// Range of all plots, in the bar at the top.
function showRange() {
  const text = document.querySelector(".bar .range");
  const any = linked.plots.some((plot) => plot.view);
  const reset = document.querySelector(".bar .reset");
  if (reset) reset.disabled = !any;
  if (text) text.textContent = linked.view ? `${hourText(linked.view[0], 1e-3)} to ${hourText(linked.view[1], 1e-3)} h` : "";
}

// Pointer: drag chooses a range, with Shift or by touch it moves the range; two fingers zoom.
function listen(plot) {
  const { svg } = plot, down = new Map();
  const xOf = (event) => {
    const at = event.clientX - svg.getBoundingClientRect().left;
    return plot.fromPx(Math.max(plot.left, Math.min(plot.right, at)));
  };
  const brush = (from, to) => {
    const [a, b] = [plot.toPx(Math.min(from, to)), plot.toPx(Math.max(from, to))];
    plot.brush.setAttribute("x", a);
    plot.brush.setAttribute("y", plot.top);
    plot.brush.setAttribute("width", Math.max(0, b - a));
    plot.brush.setAttribute("height", plot.bottom - plot.top);
  };
  svg.addEventListener("pointerdown", (event) => {
    if (event.button > 1 || !plot.x) return;
    const moves = event.shiftKey || event.button === 1 || event.pointerType === "touch";
    down.set(event.pointerId, { from: xOf(event), moves, clientX: event.clientX, range: plot.range() });
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    if (!plot.x) return;
    const start = down.get(event.pointerId);
    if (down.size === 2 && start) return pinch(event);
    if (start && !start.moves) brush(start.from, xOf(event));
    if (start && start.moves && plot.isZoomed()) {
      const by = ((start.clientX - event.clientX) / (plot.right - plot.left)) * (start.range[1] - start.range[0]);
      show(plot, start.range.map((x) => x + by));
      return;
    }
    moveCursors(plot, xOf(event));
  });
  const pinch = (event) => {
    const [a, b] = [...down.values()], own = down.get(event.pointerId), other = own === a ? b : a;
    const before = Math.abs((own.latest ?? own.clientX) - (other.latest ?? other.clientX));
    own.latest = event.clientX;
    const after = Math.abs(own.latest - (other.latest ?? other.clientX));
    if (before > 20 && after > 20) zoom(plot, before / after, (own.from + other.from) / 2);
  };
  const up = (event) => {
    const start = down.get(event.pointerId);
    down.delete(event.pointerId);
    brush(plot.x?.[0] ?? 0, plot.x?.[0] ?? 0);
    if (!start || start.moves || event.type === "pointercancel") return;
    const to = xOf(event);
    if (Math.abs(event.clientX - start.clientX) > 4) show(plot, [Math.min(start.from, to), Math.max(start.from, to)]);
  };
  svg.addEventListener("pointerup", up);
  svg.addEventListener("pointercancel", up);
  svg.addEventListener("pointerleave", () => down.size === 0 && plot.x && moveCursors(plot, null));
  svg.addEventListener("dblclick", () => show(plot, null));
  // The plain wheel scrolls the page.
  svg.addEventListener("wheel", (event) => {
    if (!plot.x) return;
    const sideways = Math.abs(event.deltaX) > Math.abs(event.deltaY) ? event.deltaX : event.shiftKey ? event.deltaY : 0;
    if (event.ctrlKey || event.metaKey || event.altKey) zoom(plot, Math.exp(event.deltaY * 0.002), xOf(event));
    else if (sideways !== 0 && plot.isZoomed()) pan(plot, sideways / 1000);
    else return;
    event.preventDefault();
  }, { passive: false });
  svg.addEventListener("keydown", (event) => key(plot, event));
  svg.addEventListener("focus", () => (linked.active = plot));
}

// Keys of the plot that has the focus.
function key(plot, event) {
  if (event.ctrlKey || event.metaKey || event.altKey || !plot.x) return;
  const [low, high] = plot.range(), at = plot.at ?? (low + high) / 2;
  const step = (part) => moveCursors(plot, Math.max(low, Math.min(high, at + part * (high - low))));
  const actions = {
    ArrowLeft: () => (event.shiftKey ? pan(plot, -0.1) : step(-0.01)),
    ArrowRight: () => (event.shiftKey ? pan(plot, 0.1) : step(0.01)),
    "+": () => zoom(plot, 0.5, at),
    "=": () => zoom(plot, 0.5, at),
    "-": () => zoom(plot, 2, at),
    Home: () => step(-1),
    End: () => step(1),
    Escape: () => show(plot, null),
  };
  if (!actions[event.key]) return;
  actions[event.key]();
  event.preventDefault();
}

function startPlots() {
  loadMarks();
  const seen = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      const plot = linked.plots.find((one) => one.root === target);
      plot.seen = isIntersecting;
      if (isIntersecting && !plot.data) {
        plot.load();
        follow(plot);
      }
    }
    redraw();
  }, { rootMargin: "80px" });
  const sized = new ResizeObserver((entries) => {
    for (const { target } of entries) {
      const plot = linked.plots.find((one) => one.root === target);
      if (Math.abs(plot.width - target.clientWidth) > 0.5) plot.dirty = true;
    }
    redraw();
  });
  for (const block of document.querySelectorAll(".chart > script")) {
    const plot = new Plot(block.parentElement, block);
    plot.svg.tabIndex = 0;
    linked.plots.push(plot);
    listen(plot);
    seen.observe(plot.root);
    sized.observe(plot.root);
  }
  // Print shows everything, as wide as paper.
  addEventListener("beforeprint", () => {
    for (const plot of linked.plots) plot.measured = plot.root.clientWidth;
    for (const plot of linked.plots) {
      plot.before = plot.view;
      plot.view = null;
      plot.draw();
    }
  });
  addEventListener("afterprint", () => {
    for (const plot of linked.plots) plot.view = plot.before;
    redrawAll();
  });
}
