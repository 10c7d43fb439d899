// The deformed bodies, coloured by their stress.

const BLANK = 255; // where there is no stress

/**
 * Fill triangles of a picture with levels that are linear over each: the levels of all dots, BLANK outside.
 * x, y (in dots) and level have a value for each of the three corners.
 */
function fillTriangle(picture, width, height, x, y, level) {
  if (level.includes(BLANK)) return;
  const area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  if (!area) return;
  const top = Math.max(0, Math.ceil(Math.min(...y) - 0.5));
  const bottom = Math.min(height - 1, Math.floor(Math.max(...y) - 0.5));
  const ddx = ((level[1] - level[0]) * (y[2] - y[0]) - (level[2] - level[0]) * (y[1] - y[0])) / area;
  const ddy = ((level[2] - level[0]) * (x[1] - x[0]) - (level[1] - level[0]) * (x[2] - x[0])) / area;
  for (let row = top; row <= bottom; row++) {
    const at = row + 0.5;
    let [from, to] = [Infinity, -Infinity];
    for (let k = 0; k < 3; k++) {
      const m = (k + 1) % 3;
      if (at < Math.min(y[k], y[m]) || at > Math.max(y[k], y[m]) || y[k] === y[m]) continue;
      const cut = x[k] + ((at - y[k]) / (y[m] - y[k])) * (x[m] - x[k]);
      from = Math.min(from, cut);
      to = Math.max(to, cut);
    }
    const last = Math.min(width - 1, Math.floor(to - 0.5));
    for (let column = Math.max(0, Math.ceil(from - 0.5)); column <= last; column++) {
      const value = level[0] + (column + 0.5 - x[0]) * ddx + (at - y[0]) * ddy;
      picture[row * width + column] = Math.max(0, Math.min(254, Math.round(value)));
    }
  }
}

/** The nodes of the cells of one body. */
class Grid {
  constructor([elementsX, elementsY, a, b]) {
    Object.assign(this, { elementsX, elementsY, a, b });
    this.across = elementsY * b + 1; // numbers of nodes
    this.along = elementsX * a + 1;
  }

  /** Nodes around the body. */
  get ring() {
    const ring = [];
    const [n, m] = [this.along, this.across];
    for (let k = 0; k < n; k++) ring.push(k * m);
    for (let k = 1; k < m; k++) ring.push((n - 1) * m + k);
    for (let k = n - 2; k >= 0; k--) ring.push(k * m + m - 1);
    for (let k = m - 2; k >= 0; k--) ring.push(k);
    return ring;
  }

  /** Nodes along each edge of the elements. */
  *edges() {
    for (let i = 0; i <= this.elementsX; i++) {
      yield Array.from({ length: this.across }, (_, k) => i * this.a * this.across + k);
    }
    for (let j = 0; j <= this.elementsY; j++) {
      yield Array.from({ length: this.along }, (_, k) => k * this.across + j * this.b);
    }
  }
}

/** Draws states of the bodies of a stage. */
class Bodies {
  constructor(stage, palette) {
    this.grids = stage.grids.map((grid) => new Grid(grid));
    this.substrates = stage.substrates;
    this.palette = palette;
  }

  /**
   * Draw a state into axes; where a `side` is given, close to its front, with elements and its own substrates.
   * Keeps the picture for `levelAt`.
   */
  draw(axes, state, side) {
    const { left, top, right, bottom, dots } = axes;
    const close = Boolean(side);
    const substrates = side ? side.substrates.map((k) => this.substrates[k]) : this.substrates;
    axes.inside((context) => {
      for (const substrate of substrates) this.drawSubstrate(context, axes, substrate);
      const width = Math.max(1, Math.round((right - left) * dots));
      const height = Math.max(1, Math.round((bottom - top) * dots));
      const picture = new Uint8Array(width * height).fill(BLANK);
      this.grids.forEach((grid, k) => this.fill(picture, axes, grid, state.bodies[k], width, height));
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [width, height];
      const image = new ImageData(width, height);
      for (let k = 0; k < picture.length; k++) {
        if (picture[k] === BLANK) continue;
        for (let c = 0; c < 3; c++) image.data[4 * k + c] = this.palette[3 * picture[k] + c];
        image.data[4 * k + 3] = 255;
      }
      canvas.getContext("2d").putImageData(image, 0, 0);
      context.drawImage(canvas, left, top, width / dots, height / dots);
      this.grids.forEach((grid, k) => this.drawLines(context, axes, grid, state.bodies[k].nodes, close));
      for (const { adhering } of state.faces) {
        const line = Array.from({ length: adhering.length / 2 }, (_, k) => this.place(axes, adhering, k));
        for (const [color, extra] of [[axes.colors.paper, 1.5], [axes.colors.mark, 0]]) {
          context.strokeStyle = color;
          context.lineWidth = (close ? 3 : 2) + extra;
          strokeLine(context, line);
        }
      }
      this.kept = { picture, width, height, axes };
    });
    axes.drawFrame();
  }

  place(axes, points, k) {
    return [axes.x(points[2 * k]), axes.y(points[2 * k + 1])];
  }

  /** Two triangles for each cell of a body, as in shapes.png. */
  fill(picture, axes, grid, body, width, height) {
    const { elementsX, elementsY, a, b } = grid;
    const { nodes, stress } = body;
    const count = nodes.length / 2;
    const [x, y] = [new Float64Array(count), new Float64Array(count)];
    for (let k = 0; k < count; k++) {
      const [px, py] = this.place(axes, nodes, k);
      x[k] = (px - axes.left) * axes.dots;
      y[k] = (py - axes.top) * axes.dots;
    }
    const outside = (corners) =>
      corners.every((n) => x[n] < 0) || corners.every((n) => x[n] > width) ||
      corners.every((n) => y[n] < 0) || corners.every((n) => y[n] > height);
    for (let i = 0; i < elementsX; i++) for (let j = 0; j < elementsY; j++)
      for (let k = 0; k < a; k++) for (let m = 0; m < b; m++) {
        const node = (i * a + k) * grid.across + j * b + m;
        const corners = [node, node + grid.across, node + grid.across + 1, node + 1];
        if (outside(corners)) continue;
        // an element has its stresses to itself: they jump where those of the solution do
        const value = ((i * elementsY + j) * (a + 1) + k) * (b + 1) + m;
        const levels = [value, value + b + 1, value + b + 2, value + 1].map((n) => stress[n]);
        for (const triangle of [[0, 1, 2], [0, 2, 3]]) {
          fillTriangle(picture, width, height, triangle.map((n) => x[corners[n]]),
            triangle.map((n) => y[corners[n]]), triangle.map((n) => levels[n]));
        }
      }
  }

  /** The level of the stress at a place on the canvas drawn last; BLANK outside of all bodies. */
  levelAt(px, py) {
    if (!this.kept) return BLANK;
    const { picture, width, height, axes } = this.kept;
    const column = Math.floor((px - axes.left) * axes.dots);
    const row = Math.floor((py - axes.top) * axes.dots);
    return column < 0 || row < 0 || column >= width || row >= height ? BLANK : picture[row * width + column];
  }

  /** Draw the outline of a body; `close` with the edges of its elements below it. */
  drawLines(context, axes, grid, nodes, close) {
    const stroke = (line) => strokeLine(context, line.map((node) => this.place(axes, nodes, node)));
    if (close) {
      context.strokeStyle = "rgba(0, 0, 0, 0.45)";
      context.lineWidth = 0.5;
      for (const edge of grid.edges()) stroke(edge);
    }
    context.strokeStyle = axes.colors.ink;
    context.lineWidth = 1;
    stroke(grid.ring);
  }

  /** Hatch what a substrate occupies, and draw its surface. */
  drawSubstrate(context, axes, substrate) {
    context.save();
    context.beginPath();
    for (const ring of substrate.rings) {
      for (let k = 0; k < ring.length / 2; k++) {
        const [x, y] = this.place(axes, ring, k);
        if (k) context.lineTo(x, y);
        else context.moveTo(x, y);
      }
      context.closePath();
    }
    context.clip("evenodd");
    context.fillStyle = axes.colors.shade;
    context.fillRect(0, 0, axes.width, axes.height);
    context.strokeStyle = axes.colors.hatch;
    context.lineWidth = 1;
    for (let x = -axes.height; x < axes.width; x += 9) {
      strokeLine(context, [[x, axes.height], [x + axes.height, 0]]);
    }
    context.restore();
    context.strokeStyle = axes.colors.ink;
    context.lineWidth = 1;
    for (const line of substrate.surface) {
      strokeLine(context, Array.from({ length: line.length / 2 }, (_, k) => this.place(axes, line, k)));
    }
  }
}

/** Draw the colours of the stress and what they stand for, along a canvas. */
function drawColorBar(canvas, palette, scale) {
  const axes = new Axes(canvas, [-scale, scale], [0, 1], { x: "", y: "" });
  const { context, width, height } = axes;
  context.fillStyle = axes.colors.paper;
  context.fillRect(0, 0, width, height);
  const [left, right] = [10, width - 10];
  const place = (value) => left + ((value + scale) / (2 * scale)) * (right - left);
  for (let x = left; x < right; x++) {
    const level = 3 * Math.round(((x - left) / (right - left)) * 254);
    context.fillStyle = `rgb(${palette[level]}, ${palette[level + 1]}, ${palette[level + 2]})`;
    context.fillRect(x, 0, 1.5, 12);
  }
  const exponent = scale < 0.01 ? Math.floor(Math.log10(scale)) : 0;
  const ticks = ticksOf([-scale, scale].map((value) => value / 10 ** exponent), Math.min(8, width / 75));
  context.fillStyle = axes.colors.ink;
  context.strokeStyle = axes.colors.ink;
  context.textBaseline = "top";
  context.textAlign = "center";
  for (const value of ticks.values) {
    const x = place(value * 10 ** exponent);
    strokeLine(context, [[x, 12], [x, 16]]);
    const text = withMinus(value.toFixed(ticks.digits));
    const half = context.measureText(text).width / 2;
    context.fillText(text, Math.max(half, Math.min(x, width - half)), 19);
  }
  return exponent;
}
