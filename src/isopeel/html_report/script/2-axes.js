// A canvas with axes around a part of the plane.

const FONT = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';

/** The colours of the page, as its style has them at the moment: light or dark. */
function colors() {
  const style = getComputedStyle(document.documentElement);
  const names = ["ink", "paper", "quiet", "line", "box", "curve", "mark", "shade", "hatch"];
  return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** The drawing context of a canvas that has as many dots as the screen, cleared, in CSS pixels. */
function cleared(canvas) {
  const dots = window.devicePixelRatio || 1;
  const { width, height } = canvas.getBoundingClientRect();
  canvas.width = Math.round(width * dots);
  canvas.height = Math.round(height * dots);
  const context = canvas.getContext("2d");
  context.setTransform(dots, 0, 0, dots, 0, 0);
  context.font = FONT;
  context.lineJoin = "round";
  return { context, width, height, dots };
}

/** Round values in a range, about so many, and how many digits after the point distinguish them. */
function ticksOf([low, high], count) {
  const rough = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  const values = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) values.push(k * step);
  return { values, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

/** Those that are whole numbers, where there is nothing in between. */
function wholeOf(ticks) {
  return { values: ticks.values.filter(Number.isInteger), digits: 0 };
}

const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

function withMinus(text) {
  return text.replace("-", "−");
}

/** A power of ten in words, such as 10⁻³. */
function powerOfTen(exponent) {
  const digits = String(Math.abs(exponent)).replace(/\d/g, (digit) => SUPERSCRIPTS[digit]);
  return `10${exponent < 0 ? "⁻" : ""}${digits}`;
}

/** A number with so many digits, as it is read best. */
function shown(value, digits = 6) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  if (exponent >= -4 && exponent < digits) return withMinus(String(Number(value.toPrecision(digits))));
  return `${withMinus(String(Number((value / 10 ** exponent).toPrecision(digits))))}·${powerOfTen(exponent)}`;
}

/** Axes of a canvas over a part of the plane; x(value) and y(value) return the place of a point. */
class Axes {
  /**
   * `equal` widens the part so that lengths are the same both ways. `names` are of x and y, the latter written
   * on top, where it needs no turning of one's head, with the `factors` from values to the numbers at the ticks;
   * `whole` where there are whole numbers only.
   */
  constructor(canvas, [left, right], [low, high], names, { equal = false, whole = false } = {}) {
    Object.assign(this, cleared(canvas), { colors: colors(), names, factors: names.factors || { x: 1, y: 1 } });
    const { context, width, height } = this;
    context.fillStyle = this.colors.paper;
    context.fillRect(0, 0, width, height);
    this.top = 26;
    this.bottom = height - 40;
    const largest = Math.max(Math.abs(low), Math.abs(high)) * this.factors.y;
    const exponent = Math.floor(Math.log10(largest || 1));
    this.exponent = exponent < -2 || exponent > 4 ? exponent : 0;
    const rows = Math.max(2, Math.min(6, Math.floor((this.bottom - this.top) / 36)));
    this.setRanges([left, right], [low, high], rows, whole);
    if (equal) {
      const perLength = Math.min(
        (this.right - this.left) / (right - left), (this.bottom - this.top) / (high - low));
      const halfWidth = (this.right - this.left) / perLength / 2;
      const halfHeight = (this.bottom - this.top) / perLength / 2;
      const [x, y] = [(left + right) / 2, (low + high) / 2];
      this.setRanges([x - halfWidth, x + halfWidth], [y - halfHeight, y + halfHeight], rows, false);
    }
  }

  setRanges(xRange, yRange, rows, whole) {
    this.xRange = xRange;
    this.yRange = yRange;
    const scale = 10 ** this.exponent / this.factors.y;
    this.yTicks = ticksOf(yRange.map((value) => value / scale), rows);
    if (whole) this.yTicks = wholeOf(this.yTicks);
    const widths = this.yTicks.values.map(
      (value) => this.context.measureText(withMinus(value.toFixed(this.yTicks.digits))).width);
    this.left = Math.max(...widths, 8) + 14;
    this.right = this.width - 10;
    this.xTicks = ticksOf(xRange.map((value) => value * this.factors.x), Math.max(2, Math.min(8, (this.right - this.left) / 70)));
    if (whole) this.xTicks = wholeOf(this.xTicks);
  }

  x(value) {
    const [left, right] = this.xRange;
    return this.left + ((value - left) / (right - left)) * (this.right - this.left);
  }

  y(value) {
    const [low, high] = this.yRange;
    return this.bottom - ((value - low) / (high - low)) * (this.bottom - this.top);
  }

  /** The point of the plane at a place on the canvas. */
  pointAt(x, y) {
    const [left, right] = this.xRange;
    const [low, high] = this.yRange;
    return [
      left + ((x - this.left) / (this.right - this.left)) * (right - left),
      low + ((this.bottom - y) / (this.bottom - this.top)) * (high - low),
    ];
  }

  /** Call a function whose lines end at the frame. */
  inside(draw) {
    const { context } = this;
    context.save();
    context.beginPath();
    context.rect(this.left, this.top, this.right - this.left, this.bottom - this.top);
    context.clip();
    draw(context);
    context.restore();
  }

  /** Ticks, their numbers and the names of the axes. */
  drawFrame() {
    const { context, left, right, top, bottom } = this;
    context.strokeStyle = this.colors.ink;
    context.fillStyle = this.colors.ink;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(left, top);
    context.lineTo(left, bottom);
    context.lineTo(right, bottom);
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const value of this.xTicks.values) {
      const x = this.x(value / this.factors.x);
      context.moveTo(x, bottom);
      context.lineTo(x, bottom + 4);
      const text = withMinus(value.toFixed(this.xTicks.digits));
      const half = context.measureText(text).width / 2;
      context.fillText(text, Math.min(x, this.width - half - 1), bottom + 7);
    }
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const value of this.yTicks.values) {
      const y = this.y(value * 10 ** this.exponent / this.factors.y);
      context.moveTo(left, y);
      context.lineTo(left - 4, y);
      context.fillText(withMinus(value.toFixed(this.yTicks.digits)), left - 7, y);
    }
    context.stroke();
    context.fillStyle = this.colors.quiet;
    context.textBaseline = "alphabetic";
    context.fillText(this.names.x, right, this.height - 4);
    context.textAlign = "left";
    context.fillText(this.exponent ? this.names.y.replace("/", `/ ${powerOfTen(this.exponent)}`) : this.names.y, 2, 13);
  }
}

/** Stroke a line through points that come one by one; where a point is no number, it is broken. */
function strokeLine(context, points) {
  context.beginPath();
  let broken = true;
  for (const [x, y] of points) {
    if (!Number.isFinite(x + y)) broken = true;
    else if (broken) {
      context.moveTo(x, y);
      broken = false;
    } else context.lineTo(x, y);
  }
  context.stroke();
}
