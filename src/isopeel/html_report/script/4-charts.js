// The curve, the iterations and the tractions.

const [STABLE, UNSTABLE, JUMP] = [0, 1, 2]; // what lies between a step and the one before
const LEAST_SPACING = 7; // CSS pixels between steps that are marked: closer marks would hide the line

/** Columns of a stage's curve. */
class Curve {
  constructor(stored) {
    this.parameter = { ...stored.parameter, values: numbersOf(stored.parameter.values, Float64Array) };
    this.reaction = { ...stored.reaction, values: numbersOf(stored.reaction.values, Float64Array) };
    this.iterations = numbersOf(stored.iterations, Int32Array);
    this.storedEnergy = numbersOf(stored.stored_energy, Float32Array);
    this.adhesiveEnergy = numbersOf(stored.adhesive_energy, Float32Array);
    this.releasedEnergy = numbersOf(stored.released_energy, Float32Array);
    this.energyUnit = stored.energy_unit;
    this.kind = numbersOf(stored.kind, Uint8Array);
    this.pieces = numbersOf(stored.pieces, Uint8Array);
    this.kinds = stored.kinds;
    const values = this.parameter.values;
    /** Does each parameter belong to one step? */
    this.oneWay = values.every((value, k) => k < 2 || (value - values[k - 1]) * (values[1] - values[0]) > 0);
  }

  get length() {
    return this.parameter.values.length;
  }

  /** Steps of a kind. */
  of(name) {
    const number = this.kinds.indexOf(name);
    return Array.from(this.kind.keys()).filter((k) => this.kind[k] === number);
  }

  point(axes, k) {
    return [axes.x(this.parameter.values[k]), axes.y(this.reaction.values[k])];
  }

  /** Of some steps the one that is seen next to a place; along the curve where it turns back. */
  nearest(axes, steps, px, py) {
    let [best, least] = [steps[0], Infinity];
    for (const k of steps) {
      const [x, y] = this.point(axes, k);
      const distance = Math.abs(x - px) + (this.oneWay ? 0 : Math.abs(y - py));
      if (distance < least) [best, least] = [k, distance];
    }
    return best;
  }

  /** A value with its symbol and unit, such as "F = 1.63 N/m". */
  static withUnit(column, k, digits) {
    const gap = column.unit === "°" ? "" : "\u00a0";
    return `${shown(column.values[k], digits)}${gap}${column.unit}`;
  }

  /** The text on a step: its parameter, reaction and iterations. */
  summary(k) {
    const parameter = Curve.withUnit(this.parameter, k, 6);
    const reaction = `${this.reaction.symbol} = ${Curve.withUnit(this.reaction, k, 6)}`;
    const count = this.iterations[k];
    return `${parameter} · ${reaction} · ${count} ${count === 1 ? "iteration" : "iterations"}`;
  }

  /** What else is known of a step: its number, its kind, and its energies. */
  details(k) {
    const kind = this.kinds[this.kind[k]];
    const parts = [
      `step ${k}${kind === "requested" ? "" : `, ${kind}`}${this.pieces[k] === UNSTABLE ? ", unstable" : ""}`,
      `stored energy ${shown(this.storedEnergy[k], 5)}`,
      `adhesive energy ${shown(this.adhesiveEnergy[k], 5)}`,
      ...(kind === "jump" ? [`released ${shown(this.releasedEnergy[k], 3)}`] : []),
    ];
    return `${parts.join(" · ")} ${this.energyUnit}`;
  }

  label(column) {
    return `${column.words} / ${column.unit === "°" ? "degree" : column.unit.includes("/") ? `(${column.unit})` : column.unit}`;
  }

  /** Stable states solid, unstable ones dashed, what a jump leapt over dotted. */
  draw(canvas, view, theory, window, states, chosen, hovered) {
    const names = { x: this.label(this.parameter), y: this.label(this.reaction) };
    const axes = new Axes(canvas, view.x, view.y, names);
    axes.inside((context) => {
      const { ink, quiet, shade, curve, mark, paper } = axes.colors;
      if (window) {
        context.fillStyle = shade;
        context.fillRect(axes.x(window[0]), axes.top, axes.x(window[1]) - axes.x(window[0]), axes.bottom);
      }
      this.drawTheory(context, axes, theory, quiet);
      context.strokeStyle = curve;
      const looks = [[STABLE, [], 2], [UNSTABLE, [5, 3], 1.2], [JUMP, [1, 3], 1.2]];
      for (const [piece, dashes, thickness] of looks) {
        context.setLineDash(dashes);
        context.lineWidth = thickness;
        strokeLine(context, this.line(axes, piece));
      }
      context.setLineDash([]);
      const disc = (k, radius, fill, stroke) => {
        context.beginPath();
        context.arc(...this.point(axes, k), radius, 0, 2 * Math.PI);
        context.fillStyle = fill;
        context.fill();
        context.strokeStyle = stroke;
        context.lineWidth = 1.5;
        context.stroke();
      };
      const seen = Array.from(this.kind.keys()).filter((k) => {
        const x = this.parameter.values[k];
        return x >= view.x[0] && x <= view.x[1];
      });
      const marked = axes.right - axes.left >= LEAST_SPACING * seen.length;
      if (marked) for (const k of seen) disc(k, 1.2, curve, curve);
      for (const k of this.of("limit point")) disc(k, 1.5, quiet, quiet);
      for (const k of states) disc(k, 3.5, paper, curve);
      if (hovered !== null) {
        context.strokeStyle = quiet;
        context.lineWidth = 1;
        const [x, y] = this.point(axes, hovered);
        strokeLine(context, [[x, axes.top], [x, axes.bottom]]);
        strokeLine(context, [[axes.left, y], [axes.right, y]]);
        disc(hovered, 3, ink, paper);
      }
      disc(chosen, 6, mark, paper);
    });
    axes.drawFrame();
    return axes;
  }

  /** The points of the pieces of one sort, broken where others are. */
  *line(axes, piece) {
    if (this.length === 1 && piece === STABLE) yield this.point(axes, 0);
    for (let k = 1; k < this.length; k++) {
      if (this.pieces[k] !== piece) continue;
      if (k === 1 || this.pieces[k - 1] !== piece) {
        yield [NaN, NaN];
        yield this.point(axes, k - 1);
      }
      yield this.point(axes, k);
    }
  }

  drawTheory(context, axes, theory, color) {
    if (!theory) return;
    context.strokeStyle = color;
    context.fillStyle = color;
    context.lineWidth = 1;
    context.setLineDash([5, 4]);
    const y = axes.y(theory.reaction);
    strokeLine(context, [[axes.left, y], [axes.right, y]]);
    context.textAlign = "left";
    const above = y - axes.top > 16; // where there is room for words
    context.textBaseline = above ? "bottom" : "top";
    context.fillText(`${theory.source} ${shown(theory.reaction, 5)}`, axes.left + 6, y + (above ? -3 : 4));
    context.textBaseline = "bottom";
    if (theory.onset !== null) {
      const x = axes.x(theory.onset);
      strokeLine(context, [[x, axes.bottom], [x, y]]);
      context.fillText(`onset ${shown(theory.onset, 3)}${this.parameter.unit}`, x + 5, axes.bottom - 4);
    }
    context.setLineDash([]);
  }

  /** A bar for each step. */
  drawIterations(canvas, chosen) {
    const most = this.iterations.reduce((a, b) => Math.max(a, b), 1);
    const names = { x: "step", y: "iterations" };
    const axes = new Axes(canvas, [-0.5, this.length - 0.5], [0, most * 1.08], names, { whole: true });
    axes.inside((context) => {
      // whole pixels from one bar to the next, as parts of them would make stripes
      const bar = (k, least, color) => {
        const [from, to] = [Math.round(axes.x(k - 0.5)), Math.round(axes.x(k + 0.5))];
        const width = Math.max(least, to - from > 4 ? to - from - 1 : to - from);
        context.fillStyle = color;
        const y = axes.y(this.iterations[k]);
        context.fillRect(from, y, width, axes.bottom - y);
      };
      for (let k = 0; k < this.length; k++) bar(k, 1, axes.colors.curve);
      context.fillStyle = axes.colors.mark;
      const x = axes.x(chosen);
      context.fillRect(x - 1, axes.top, 2, axes.bottom - axes.top);
      bar(chosen, 3, axes.colors.mark);
    });
    axes.drawFrame();
    return axes;
  }
}

/** The least and the largest tension of the adhesion on faces, with zero. */
function rangeOf(faces) {
  const all = faces.flatMap((face) => Array.from(face.adhesion)).filter(Number.isFinite);
  return [all.reduce((a, b) => Math.min(a, b), 0), all.reduce((a, b) => Math.max(a, b), 0)];
}

/** Tractions along one of the faces that adhere. */
class Tractions {
  constructor(units, side, faces, least) {
    this.units = units;
    this.position = numbersOf(side.position, Float32Array);
    this.points = side.points;
    this.whole = [this.position[0], this.position[this.position.length - 1]]; // the ends of the face
    this.places = numbersOf(side.places, Float32Array); // of the points of the deformed face
    // one scale for all states, so that a peak that moves keeps its size
    let [low, high] = rangeOf(faces);
    // the round-off of a face at rest beside others has no scale of its own
    if (Math.max(-low, high) < least) [low, high] = [-least, least];
    const margin = 0.12 * (high - low || 1);
    this.yRange = [low - margin, high + margin];
  }

  /** The part of the face that is seen in the picture of the front. */
  partOf(face) {
    const [left, right, low, high] = face.front;
    const seen = this.places.filter((_, k) => {
      const [x, y] = [face.adhering[2 * k], face.adhering[2 * k + 1]];
      return x >= left && x <= right && y >= low && y <= high;
    });
    return seen.length > 1 && seen.length < this.places.length ? [seen[0], seen[seen.length - 1]] : this.whole;
  }

  draw(canvas, face, close) {
    const part = this.partOf(face);
    const { length, stress } = this.units;
    const names = {
      x: `place along the undeformed face / ${length.name}`,
      y: `tension / ${stress.name}`,
      factors: { x: length.factor, y: stress.factor },
    };
    const axes = new Axes(canvas, close ? part : this.whole, this.yRange, names);
    axes.inside((context) => {
      const { shade, curve, mark, line } = axes.colors;
      if (!close && part !== this.whole) {
        context.fillStyle = shade;
        context.fillRect(axes.x(part[0]), axes.top, axes.x(part[1]) - axes.x(part[0]), axes.bottom);
      }
      context.strokeStyle = line;
      context.lineWidth = 1;
      strokeLine(context, [[axes.left, axes.y(0)], [axes.right, axes.y(0)]]);
      for (const [values, color, width] of [[face.body, curve, 1], [face.adhesion, mark, 2]]) {
        context.strokeStyle = color;
        context.lineWidth = width;
        strokeLine(context, this.line(axes, values));
      }
    });
    axes.drawFrame();
    return axes;
  }

  /** The points of all elements; between two of them the line is broken, as tractions may jump there. */
  *line(axes, values) {
    for (let k = 0; k < values.length; k++) {
      if (k % this.points === 0) yield [NaN, NaN];
      yield [axes.x(this.position[k]), axes.y(values[k])];
    }
  }
}
