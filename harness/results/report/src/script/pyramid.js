// Columns of numbers, and their extremes at every scale.

// Decodes a column: little-endian single precision in base64, with a tilde for N.
function decodeColumn(text) {
  const raw = atob(text.replaceAll("~", "N"));
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i += 1) bytes[i] = raw.charCodeAt(i);
  // Values beyond every number have no place in a drawing.
  return new Float32Array(bytes.buffer).map((value) => (Number.isFinite(value) ? value : NaN));
}

// Index of the first element of a sorted column that isn't below a value.
function lowerBound(column, value) {
  let low = 0, high = column.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (column[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

// Smallest and largest values of blocks of 2, 4, 8 … elements: a drawing of any stretch of a column costs
// as much as it has pixels, whatever the length of the column.
class Pyramid {
  constructor(values) {
    this.values = values;
    this.levels = [{ low: values, high: values }];
    while (this.levels.at(-1).low.length > 64) {
      const { low, high } = this.levels.at(-1);
      const count = Math.ceil(low.length / 2);
      const next = { low: new Float32Array(count), high: new Float32Array(count) };
      for (let i = 0; i < count; i += 1) {
        const a = 2 * i, b = Math.min(a + 1, low.length - 1);
        // A block without numbers has none; a block with some has theirs.
        next.low[i] = low[a] <= low[b] || Number.isNaN(low[b]) ? low[a] : low[b];
        next.high[i] = high[a] >= high[b] || Number.isNaN(high[b]) ? high[a] : high[b];
      }
      this.levels.push(next);
    }
  }

  // The finest level at which the elements from..to have at most this many blocks.
  level(from, to, blocks) {
    let level = 0;
    while (level < this.levels.length - 1 && (to - from) >> level > blocks) level += 1;
    return level;
  }

  // Smallest and largest number among the elements from..to.
  extent(from, to) {
    const level = this.level(from, to, 256), { low, high } = this.levels[level];
    const extent = [Infinity, -Infinity];
    for (let i = from >> level; i < low.length && i << level < to; i += 1) {
      if (low[i] < extent[0]) extent[0] = low[i];
      if (high[i] > extent[1]) extent[1] = high[i];
    }
    return extent;
  }
}
