// The panels of a stage, which all show one of its stored states.

const FRAME_MILLISECONDS = 450; // for a state, where they play by themselves
const HEIGHT_OF_AXES = 66; // in CSS pixels, of their names and numbers
const LEAST_TENSION = 1e-3; // of the largest of all faces: less is drawn as none

class Stage {
  constructor(section, content, palette) {
    this.section = section;
    this.content = content;
    this.palette = palette;
    this.curve = new Curve(content.curve);
    this.states = content.states.map(unpackedState);
    this.steps = this.states.map((state) => state.step);
    const least = LEAST_TENSION * Math.max(...rangeOf(this.states.flatMap((state) => state.faces)).map(Math.abs));
    this.tractions = content.sides.map(
      (side, k) => new Tractions(content.units, side, this.states.map((state) => state.faces[k]), least));
    this.whole = new Bodies(content, palette);
    this.front = new Bodies(content, palette);
    this.view = content.views[0];
    this.interface = 0; // the number of the one that is shown
    this.close = false;
    this.hovered = null;
    this.slider = this.find("input");
    this.canvas = Object.fromEntries(
      ["curve", "body", "front", "tractions", "iterations", "colors"].map((name) => [name, this.find(`canvas.${name}`)]));
    section.classList.add("ready");
    this.fillViews(this.find(".curve-views"), content.views, (view) => { this.view = view; });
    this.fillViews(this.find(".side-views"), [{ name: "whole face" }, { name: "at the front" }],
      (view) => { this.close = view.name === "at the front"; });
    this.fillViews(this.find(".interface-views"), content.sides,
      (side) => { this.interface = content.sides.indexOf(side); });
    for (const figure of section.querySelectorAll(".on-interface")) figure.hidden = !content.sides.length;
    this.listen();
    this.choose(this.states.length - 1);
    // where the window changes or a screen is turned; later, as drawing changes heights
    new ResizeObserver(() => requestAnimationFrame(() => this.draw())).observe(this.find(".panels"));
    for (const query of ["(prefers-color-scheme: dark)", "print"]) {
      window.matchMedia(query).addEventListener("change", () => this.draw());
    }
  }

  find(selector) {
    return this.section.querySelector(selector);
  }

  /** A button for each view, of which one is pressed. */
  fillViews(group, views, choose) {
    group.hidden = views.length < 2;
    for (const view of views) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = view.name;
      button.setAttribute("aria-pressed", String(view === views[0]));
      button.addEventListener("click", () => {
        for (const other of group.querySelectorAll("button")) {
          other.setAttribute("aria-pressed", String(other === button));
        }
        choose(view);
        this.draw();
      });
      group.append(button);
    }
  }

  listen() {
    const last = this.states.length - 1;
    this.slider.max = String(last);
    this.find(".bar").hidden = last < 1;
    this.slider.addEventListener("input", () => {
      this.pause();
      this.choose(Number(this.slider.value));
    });
    this.find(".play").addEventListener("click", () => (this.timer ? this.pause() : this.play()));
    this.onPointer(this.canvas.curve, (x, y, chosen) => {
      const axes = this.curveAxes;
      this.hovered = this.curve.nearest(axes, Array.from(this.curve.kind.keys()), x, y);
      if (chosen) this.choose(this.steps.indexOf(this.curve.nearest(axes, this.steps, x, y)));
      else this.drawCurve();
    }, () => {
      this.hovered = null;
      this.drawCurve();
    });
    this.onPointer(this.canvas.iterations, (x, y, chosen) => {
      if (!chosen) return;
      const [at] = this.iterationAxes.pointAt(x, y);
      const distance = (step) => Math.abs(step - at);
      this.choose(this.steps.indexOf(this.steps.reduce((a, b) => (distance(b) < distance(a) ? b : a))));
    });
    for (const [name, body] of [["body", this.whole], ["front", this.front]]) {
      const readout = this.find(`.${name}-readout`);
      this.onPointer(this.canvas[name], (x, y) => {
        const level = body.levelAt(x, y);
        const value = (level / 127 - 1) * this.content.scale;
        readout.textContent = level === BLANK ? "" : `I₁ = ${shown(value, 2)}`;
      }, () => { readout.textContent = ""; });
    }
  }

  /** Report the place of a pointer on a canvas, whether it is pressed, and when it leaves. */
  onPointer(canvas, moved, left = () => {}) {
    const report = (event, pressed) => {
      const { x, y } = canvas.getBoundingClientRect();
      if (pressed) this.pause();
      moved(event.clientX - x, event.clientY - y, pressed);
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      report(event, true);
    });
    canvas.addEventListener("pointermove", (event) => report(event, event.buttons > 0));
    canvas.addEventListener("pointerleave", left);
  }

  play() {
    if (this.chosen === this.states.length - 1) this.choose(0);
    this.timer = setInterval(() => {
      this.choose(this.chosen + 1);
      if (this.chosen === this.states.length - 1) this.pause();
    }, FRAME_MILLISECONDS);
    this.sayWhatPlayDoes();
  }

  pause() {
    clearInterval(this.timer);
    this.timer = undefined;
    this.sayWhatPlayDoes();
  }

  sayWhatPlayDoes() {
    const button = this.find(".play");
    button.textContent = this.timer ? "❚❚" : "▶";
    button.setAttribute("aria-label", this.timer ? "pause" : "play");
  }

  /** Show the stored state of a number from zero. */
  choose(number) {
    this.chosen = number;
    this.slider.value = String(number);
    const { step, residuals } = this.states[number];
    const summary = this.curve.summary(step);
    this.slider.setAttribute("aria-valuetext", summary);
    this.find(".state-readout").textContent = summary;
    const words = residuals.map((value) => shown(value, 2)).join(", ");
    this.find(".residuals").textContent = residuals.length ? `Energy residuals of this step: ${words}` : "";
    this.draw();
  }

  draw() {
    // before the first size is known, and on a part of the page that is not shown
    if (!this.canvas.curve.getBoundingClientRect().width) return;
    const { content, canvas } = this;
    const state = this.states[this.chosen];
    this.drawCurve();
    const { name, factor } = content.units.length;
    const names = { x: `x / ${name}`, y: `y / ${name}`, factors: { x: factor, y: factor } };
    const [left, right, low, high] = content.whole;
    this.fit(canvas.body, (right - left) / (high - low));
    const axes = new Axes(canvas.body, [left, right], [low, high], names, { equal: true });
    this.whole.draw(axes, state, null);
    const face = state.faces[this.interface];
    if (face) {
      const [l, r, b, t] = face.front;
      this.fit(canvas.front, (r - l) / (t - b));
      this.drawFrontFrame(axes, face.front);
      this.front.draw(new Axes(canvas.front, [l, r], [b, t], names, { equal: true }), state, content.sides[this.interface]);
      this.tractions[this.interface].draw(canvas.tractions, face, this.close);
    }
    this.iterationAxes = this.curve.drawIterations(canvas.iterations, state.step);
    const exponent = drawColorBar(canvas.colors, this.palette, content.scale);
    this.find(".power").textContent = exponent ? `, in ${powerOfTen(exponent)}` : "";
  }

  /** Make a picture as high as it needs to be, where it has the width of the page to itself. */
  fit(canvas, aspect) {
    const alone = !window.matchMedia("(min-width: 60rem)").matches;
    const height = canvas.getBoundingClientRect().width / aspect + HEIGHT_OF_AXES;
    canvas.style.height = alone ? `${Math.min(Math.max(height, 150), 400)}px` : "";
  }

  drawCurve() {
    const { content } = this;
    const step = this.steps[this.chosen];
    this.curveAxes = this.curve.draw(
      this.canvas.curve, this.view, content.theory, content.window, this.steps, step, this.hovered);
    const at = this.hovered ?? step;
    this.find(".curve-readout").textContent =
      (this.hovered === null ? "" : `${this.curve.summary(at)} · `) + this.curve.details(at);
  }

  /** Where the picture of the front is in that of the whole body. */
  drawFrontFrame(axes, [left, right, low, high]) {
    axes.inside((context) => {
      context.strokeStyle = axes.colors.ink;
      context.lineWidth = 1;
      context.setLineDash([4, 3]);
      const [x, y] = [axes.x(left), axes.y(high)];
      context.strokeRect(x, y, axes.x(right) - x, axes.y(low) - y);
      context.setLineDash([]);
    });
  }
}

const content = JSON.parse(document.getElementById("content").textContent);
const palette = numbersOf(content.palette, Uint8Array);
for (const [id, stage] of Object.entries(content.stages)) {
  new Stage(document.getElementById(id), stage, palette);
}
