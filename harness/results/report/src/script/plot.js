// One plot: its numbers drawn as SVG for the width that the reader has and the range that is looked at.

let clips = 0;

function element(name, attributes = {}, text) {
  // The name space is that of the drawings which the page came with.
  const made = document.createElementNS(document.querySelector("svg").namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

const px = (value) => Math.round(value * 10) / 10;

class Plot {
  constructor(root, block) {
    this.root = root;
    this.block = block;
    this.svg = root.querySelector("svg[role=img]");
    this.view = null; // Range of x that is looked at; null: all of it.
    this.width = 0; // Width of the drawing; `measured` is that of the page.
    this.measured = 0;
    this.dirty = true;
    this.seen = false;
  }

  // Reads the numbers, when the plot is first seen.
  load() {
    if (this.data) return;
    const data = JSON.parse(this.block.textContent);
    const columns = data.columns.map(decodeColumn);
    const pyramids = columns.map(() => null);
    const pyramid = (i) => (pyramids[i] ??= new Pyramid(columns[i]));
    for (const line of data.lines) [line.x, line.y] = [columns[line.x], pyramid(line.y)];
    for (const band of data.bands) {
      [band.x, band.low, band.high] = [columns[band.x], pyramid(band.low), pyramid(band.high)];
    }
    const all = [...data.lines, ...data.bands].filter((one) => one.x.length > 0);
    this.span = [Math.min(...all.map((one) => one.x[0])), Math.max(...all.map((one) => one.x.at(-1)))];
    // Points at the ends have room for their dots.
    if (data.decades) this.span = [this.span[0] - 0.08, this.span[1] + 0.08];
    this.data = data;
    this.build();
  }

  // Replaces the static drawing by layers, and gives the legend room for values.
  build() {
    const id = `clip-${(clips += 1)}`;
    this.clip = element("rect");
    const path = element("clipPath", { id });
    path.append(this.clip);
    const clipped = () => element("g", { "clip-path": "url" + `(#${id})` });
    this.layers = { grid: element("g"), marks: clipped(), curves: clipped(), notes: element("g"), over: element("g") };
    this.paths = [];
    for (const band of this.data.bands) this.paths.push(element("path", { class: `band ${band.role}` }));
    for (const line of this.data.lines) this.paths.push(element("path", { class: `line ${line.role}` }));
    this.layers.curves.append(...this.paths);
    this.cursor = element("path", { class: "cursor" });
    this.time = element("text", { class: "tick time" });
    this.dots = this.data.lines.map((line) => element("circle", { class: `at ${line.role}`, r: 3 }));
    this.brush = element("rect", { class: "brush" });
    this.layers.over.append(this.brush, this.cursor, ...this.dots, this.time);
    this.svg.replaceChildren(path, ...Object.values(this.layers));
    const keys = Array.from(this.root.querySelectorAll(".legend .key"));
    const caption = this.root.querySelector(".caption");
    this.values = this.data.lines.map((line, i) => {
      const value = document.createElement("output");
      value.className = "readout";
      // The legend names the lines from the last to the first.
      (keys[this.data.lines.length - 1 - i] ?? caption).append(value);
      return value;
    });
    this.svg.setAttribute("preserveAspectRatio", "none");
  }

  // Range of x that is drawn.
  range() {
    if (!this.view) return this.span;
    const low = Math.max(this.view[0], this.span[0]), high = Math.min(this.view[1], this.span[1]);
    return high > low ? [low, high] : this.span;
  }

  isZoomed() {
    const [low, high] = this.range();
    return low > this.span[0] || high < this.span[1];
  }

  toPx(x) {
    return this.left + ((x - this.x[0]) / (this.x[1] - this.x[0])) * (this.right - this.left);
  }

  fromPx(at) {
    return this.x[0] + ((at - this.left) / (this.right - this.left)) * (this.x[1] - this.x[0]);
  }

  yPx(y) {
    const part = this.data.log
      ? Math.log(y / this.y[0]) / Math.log(this.y[1] / this.y[0])
      : (y - this.y[0]) / (this.y[1] - this.y[0]);
    return this.bottom - Math.max(-4, Math.min(5, part)) * (this.bottom - this.top);
  }

  // Elements of a column of x that a range needs, with one neighbour on each side.
  stretch(x) {
    return [Math.max(0, lowerBound(x, this.x[0]) - 1), Math.min(x.length, lowerBound(x, this.x[1]) + 1)];
  }

  // Chooses the range of y: what is in sight, with room.
  scale() {
    const { data } = this;
    let [low, high] = [Infinity, -Infinity];
    const take = (pyramid, from, to) => {
      let [a, b] = pyramid.extent(from, to);
      if (data.log && a <= 0) {
        a = Infinity;
        for (let i = from; i < to; i += 1) if (pyramid.values[i] > 0) a = Math.min(a, pyramid.values[i]);
      }
      [low, high] = [Math.min(low, a), Math.max(high, b)];
    };
    for (const line of data.lines) take(line.y, ...this.stretch(line.x));
    for (const band of data.bands) {
      take(band.low, ...this.stretch(band.x));
      take(band.high, ...this.stretch(band.x));
    }
    if (!this.isZoomed() || data.range) for (const [value] of data.levels) [low, high] = [Math.min(low, value), Math.max(high, value)];
    if (!(high >= low)) [low, high] = data.log ? [0.1, 1] : [-1, 1];
    if (data.log) {
      const decade = (y, round) => 10 ** round(Math.log10(y));
      if (data.range && !this.isZoomed()) [low, high] = data.range;
      return this.isZoomed() ? [low / 1.3, high * 1.3] : [decade(low * 1.0000001, Math.floor), decade(high * 0.9999999, Math.ceil)];
    }
    // A range that the page sets holds for the whole; zero stays the lower end.
    if (data.range && !this.isZoomed()) return data.range;
    if (data.range && data.range[0] === 0) return [0, Math.max(high * 1.1, 1e-12)];
    const room = high > low ? 0.04 * (high - low) : Math.abs(high) || 1;
    return [low - room, high + (data.bracket && !this.isZoomed() ? 3.5 : 1) * room];
  }

  draw() {
    this.load();
    this.dirty = false;
    const width = this.measured || 960;
    const height = Math.max(150, Math.min(this.data.height, 0.62 * width + 60));
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    [this.width, this.height, this.x] = [width, height, this.range()];
    [this.top, this.bottom, this.right] = [10, height - 36, width - 10];
    this.y = this.scale();
    if (this.data.log && this.y[1] <= this.y[0]) this.y = [this.y[0] / 10, this.y[0] * 10];
    this.grid();
    this.clip.setAttribute("x", this.left);
    this.clip.setAttribute("y", this.top - 2);
    this.clip.setAttribute("width", Math.max(0, this.right - this.left));
    this.clip.setAttribute("height", this.bottom - this.top + 4);
    const { bands, lines } = this.data;
    bands.forEach((band, i) => this.paths[i].setAttribute("d", this.area(band)));
    lines.forEach((line, i) => this.paths[bands.length + i].setAttribute("d", this.path(line)));
    if (this.data.dots) this.points();
    drawMarks(this);
    this.root.classList.toggle("zoomed", this.isZoomed());
    this.moveCursor(this.at);
  }

  grid() {
    const { data, y } = this, rows = Math.max(2, Math.min(6, Math.round((this.bottom - this.top) / 38)));
    let yTicks;
    if (data.log) {
      yTicks = logTicks(y).map((tick) => [tick, tickText(tick, tick)]);
    } else {
      const { ticks, step } = niceTicks(y, rows, data.step);
      yTicks = ticks.map((tick) => [Math.abs(tick) < step / 1e6 ? 0 : tick, tickText(tick, step)]);
    }
    const longest = Math.max(0, ...yTicks.map(([, text]) => text.length));
    this.left = Math.max(this.width < 420 ? 38 : 52, 6.8 * longest + 12);
    const count = Math.max(2, (this.right - this.left) / 64);
    const xTicks = this.xTicks(count);
    const parts = [];
    for (const [tick, text] of yTicks) {
      const at = px(this.yPx(tick));
      parts.push(element("path", { class: tick === 0 ? "grid zero" : "grid", d: `M${px(this.left)} ${at}H${this.right}` }));
      parts.push(element("text", { class: "tick y", x: px(this.left - 7), y: at + 3.8 }, text));
    }
    for (const [tick, text] of xTicks) {
      const at = px(this.toPx(tick));
      parts.push(element("path", { class: "mark", d: `M${at} ${this.bottom}v5` }));
      parts.push(element("text", { class: "tick x", x: Math.min(at, this.width - 14), y: this.bottom + 18 }, text));
    }
    parts.push(element("path", { class: "axis", d: `M${px(this.left)} ${this.bottom}H${this.right}` }));
    parts.push(element("text", { class: "tick xlabel", x: this.right, y: this.bottom + 33 }, data.xLabel));
    this.layers.grid.replaceChildren(...parts);
    this.layers.notes.replaceChildren(...this.notes());
  }

  // Ticks of x with their labels.
  xTicks(count) {
    if (this.data.decades) return decadeTicks(this.x, count).map(([place, value]) => [place, tickText(value, value)]);
    const { ticks, step } = this.data.hours ? hourTicks(this.x, count) : niceTicks(this.x, count);
    return ticks.map((tick) => [tick, this.data.hours ? hourText(tick, step) : tickText(tick, step)]);
  }

  // Levels with their labels, and the bracket of a reference period.
  notes() {
    const parts = [];
    for (const [value, label] of this.data.levels) {
      if (value < this.y[0] || value > this.y[1]) continue;
      const at = px(this.yPx(value));
      parts.push(element("path", { class: "line reference", d: `M${px(this.left)} ${at}H${this.right}` }));
      parts.push(element("text", { class: "note", x: this.right - 4, y: at - 5 }, label));
    }
    if (this.data.bracket) {
      const [length, label] = this.data.bracket;
      const from = this.left + 10, to = from + (length / (this.x[1] - this.x[0])) * (this.right - this.left);
      const room = 6.2 * label.length + 10;
      if (to + room < this.right && to - from > 6) {
        const y = this.top + 6;
        parts.push(element("path", { class: "bracket", d: `M${px(from)} ${y - 4}v8m0 -4H${px(to)}m0 -4v8` }));
        parts.push(element("text", { class: "note start", x: px(to + 7), y: y + 4 }, label));
      }
    }
    return parts;
  }

  path({ x, y }) {
    const [from, to] = this.stretch(x);
    const level = y.level(from, to, this.width), { low, high } = y.levels[level];
    let d = "", down = false;
    const point = (at, value) => {
      d += `${down ? "L" : "M"}${at} ${px(this.yPx(value))}`;
      down = true;
    };
    for (let i = from >> level; i << level < to; i += 1) {
      const a = low[i], b = high[i];
      if (!(Number.isFinite(a) && Number.isFinite(b)) || (this.data.log && a <= 0)) {
        down = false;
        continue;
      }
      const at = px(this.toPx(x[i << level]));
      point(at, a);
      if (b > a) point(at, b);
    }
    return d;
  }

  area({ x, low, high }) {
    const [from, to] = this.stretch(x);
    const level = low.level(from, to, this.width);
    const floor = (value) => (this.data.log ? Math.max(value, this.y[0]) : value);
    let upper = "", lower = "";
    for (let i = from >> level; i << level < to; i += 1) {
      const a = low.levels[level].low[i], b = high.levels[level].high[i];
      if (!(Number.isFinite(a) && Number.isFinite(b))) continue;
      const at = px(this.toPx(x[i << level]));
      upper += `${upper ? "L" : "M"}${at} ${px(this.yPx(floor(b)))}`;
      lower = `L${at} ${px(this.yPx(floor(a)))}${lower}`;
    }
    return upper && `${upper}${lower}Z`;
  }

  points() {
    this.layers.curves.replaceChildren(...this.paths);
    for (const { x, y, role } of this.data.lines) {
      if (role !== "primary" && role !== "baseline") continue; // What is expected has no dots.
      const [from, to] = this.stretch(x);
      if (to - from > 500) continue;
      for (let i = from; i < to; i += 1) {
        if (!Number.isFinite(y.values[i])) continue;
        this.layers.curves.append(element("circle", { class: `dot ${role}`, r: 3, cx: px(this.toPx(x[i])), cy: px(this.yPx(y.values[i])) }));
      }
    }
  }

  // Shows the values at x in the legend; null: none.
  moveCursor(at) {
    this.at = at;
    if (!this.x) return;
    const shown = at !== null && at !== undefined && at >= this.x[0] && at <= this.x[1];
    this.layers.over.classList.toggle("shown", shown);
    this.data.lines.forEach((line, i) => {
      let text = "";
      const { x, y } = line;
      if (shown && x.length > 0) {
        let nearest = Math.min(lowerBound(x, at), x.length - 1);
        if (nearest > 0 && at - x[nearest - 1] < x[nearest] - at) nearest -= 1;
        const value = y.values[nearest];
        text = valueText(value);
        const ok = Number.isFinite(value) && !(this.data.log && value <= 0);
        this.dots[i].setAttribute("cx", ok ? px(this.toPx(x[nearest])) : -99);
        this.dots[i].setAttribute("cy", ok ? px(this.yPx(value)) : -99);
      }
      this.values[i].textContent = text;
    });
    if (!shown) return;
    const place = px(this.toPx(at));
    this.cursor.setAttribute("d", `M${place} ${this.top}V${this.bottom}`);
    this.time.setAttribute("x", Math.max(this.left + 2, Math.min(place + 5, this.right - 60)));
    this.time.setAttribute("y", this.bottom - 5);
    this.time.textContent = this.data.hours ? `${hourText(at, 1e-3)} h` : valueText(this.data.decades ? 10 ** at : at);
  }
}
