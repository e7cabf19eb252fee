// Ticks of axes and the text of values.

function multiples(low, high, step) {
  const ticks = [];
  const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
  for (let k = first; k <= last && ticks.length < 200; k += 1) ticks.push(k * step + 0);
  return ticks;
}

// Multiples of 1, 2, 2.5 or 5 times a power of ten, about `count` of them.
function niceTicks([low, high], count, step) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const nice = [1, 2, 2.5, 5, 10].find((m) => m * power >= raw * (1 - 1e-9)) ?? 10;
  const chosen = step && (high - low) / step >= 2 && (high - low) / step <= 2.5 * count ? step : nice * power;
  return { ticks: multiples(low, high, chosen), step: chosen };
}

// Decades; their halves as well where there are few of them.
function logTicks([low, high]) {
  const ticks = [];
  const digits = Math.log10(high / low) < 1.5 ? [1, 2, 5] : [1];
  const stride = Math.ceil(Math.log10(high / low) / 7);
  for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); e += 1) {
    if (e % stride !== 0) continue;
    for (const digit of digits) {
      const tick = digit * 10 ** e;
      if (tick >= low * 0.999 && tick <= high * 1.001) ticks.push(tick);
    }
  }
  return ticks;
}

// Ticks of an axis of exponents: powers of ten, and their double and fivefold where few are in sight. Each
// is [place, what it stands for].
function decadeTicks([low, high], count) {
  const digits = high - low > 2.5 ? [1] : [1, 2, 5];
  const stride = digits.length > 1 ? 1 : Math.ceil((high - low) / count);
  const ticks = [];
  for (let e = Math.floor(low); e <= Math.ceil(high); e += 1) {
    if (e % stride !== 0) continue;
    for (const digit of digits) {
      const place = e + Math.log10(digit);
      if (place >= low - 1e-9 && place <= high + 1e-9) ticks.push([place, digit * 10 ** e]);
    }
  }
  return ticks;
}

// Steps of an axis in hours, from a second to days.
const HOUR_STEPS = [1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800].map((s) => s / 3600)
  .concat([1, 2, 3, 6, 12, 24, 48, 96, 192]);

function hourTicks([low, high], count) {
  const raw = (high - low) / count;
  const step = HOUR_STEPS.find((s) => s >= raw) ?? Math.ceil(raw / 24) * 24;
  return { ticks: multiples(low, high, step), step };
}

// Hours as a plain number, or as h:mm and h:mm:ss where the step asks for it.
function hourText(hours, step) {
  if (step >= 0.99) return String(Math.round(hours));
  if (step > 0.49) return String(Math.round(hours * 10) / 10);
  const seconds = Math.round(Math.abs(hours) * 3600);
  const two = (n) => String(n).padStart(2, "0");
  const sign = hours < 0 && seconds > 0 ? "−" : "";
  const minutes = `${sign}${Math.floor(seconds / 3600)}:${two(Math.floor(seconds / 60) % 60)}`;
  return step > 0.0166 ? minutes : `${minutes}:${two(seconds % 60)}`;
}

function tickText(value, step) {
  if (value === 0) return "0";
  const magnitude = Math.max(Math.abs(value), step);
  if (magnitude >= 1e6 || magnitude < 1e-4) return minus(value.toExponential(1).replace(".0e", "e").replace("e+", "e"));
  let decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  // A step of 2.5 needs one more.
  if (Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6) decimals += 1;
  return minus(value.toFixed(decimals));
}

function valueText(value) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const magnitude = Math.abs(value);
  const text = magnitude >= 1e5 || magnitude < 1e-4 ? value.toExponential(2).replace("e+", "e") : value.toPrecision(4);
  return minus(text);
}

function minus(text) {
  return text.replaceAll("-", "−");
}
