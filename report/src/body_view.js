// The section of the body: its scene, and the controls of step, field, scale and point.

import { Body } from "./body.js";
import { colour, gradient } from "./colours.js";
import { element } from "./dom.js";
import { pointTable } from "./point_table.js";
import { quantitiesOf } from "./quantities.js";
import { BodyScene } from "./scene.js";
import { plain, unitFor } from "./units.js";

const AXES = "xyz";
const HELP =
  "The deformed body. Drag to turn, two fingers or the right button to move, the wheel to zoom; " +
  "click a point to read its values.";
const SHOWN_SIZE = 0.08; // largest displacement over the size of the body, as it is drawn at first
const PAUSE = 140; // between the steps of the animation [ms]
const FAR = 4; // a peak above this many times the 99.5th percentile does not set the colours
const ROUND = [1, 2, 5];

export class BodyView {
  constructor(place, content, numbers, onStep) {
    this.body = new Body(content, numbers);
    this.onStep = onStep;
    this.quantities = quantitiesOf(this.body);
    this.chosen = null;
    this.#build(place);
    this.#choose(this.quantities.find(({ id }) => id === "damage") ?? this.quantities[0]);
    this.scale = this.#firstScale();
    this.parts.scale.value = this.scale;
    this.parts.slider.value = 25;
    this.#openScene();
    this.show(this.body.frames.length - 1);
  }

  show(frame) {
    this.frame = frame;
    this.parts.step.value = frame;
    this.displacements = this.body.displacements(frame);
    this.#draw();
    this.onStep(this.body.frames[frame].step);
  }

  #firstScale() {
    const wanted = (SHOWN_SIZE * this.body.content.size) / (this.body.largestDisplacement() || Infinity);
    if (!(wanted > 1)) return 1;
    const decade = 10 ** Math.floor(Math.log10(wanted));
    return Math.max(...ROUND.map((step) => step * decade).filter((value) => value <= wanted));
  }

  #openScene() {
    try {
      this.scene = new BodyScene(this.parts.canvas, this.body.dimension === 3);
    } catch (error) {
      this.parts.canvas.hidden = true;
      this.parts.note.textContent = `This browser can't draw the body, it has no WebGL (${error.message}). Values of points are below.`;
      return;
    }
    this.#frameBody();
    this.scene.onChoice((corner) => this.#pick(corner === null ? null : Math.floor(corner / this.body.cells.corners)));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.scene.draw());
  }

  /** Shows the whole body at rest and in its last state. */
  #frameBody() {
    const { body, scale } = this;
    const last = body.frames.length - 1;
    this.scene.frame(...[0, scale].map((by) => body.cells.positions(last, body.displacements(last), body.loose(last), by)));
  }

  #build(place) {
    const last = this.body.frames.length - 1;
    const range = (label, properties) => element("input", { type: "range", "aria-label": label, ...properties });
    const p = (this.parts = {
      canvas: element("canvas", {
        tabIndex: 0,
        role: "img",
        "aria-label": HELP,
      }),
      note: element("p", { className: "note", role: "status" }),
      step: range("step", { min: 0, max: last, value: last, id: "step" }),
      stepWords: element("output", { className: "step-words" }),
      play: element("button", { type: "button", textContent: "▶ Play", id: "play" }),
      field: element("select", { id: "field" }),
      scale: element("input", { type: "number", id: "scale", min: 0, step: "any" }),
      slider: range("scale of displacements", { min: 0, max: 100, step: 0.5 }),
      colours: element("select", { id: "colours" }, new Option("all steps", "all"), new Option("this step", "step")),
      bar: element("div", { className: "bar" }),
      low: element("span"),
      high: element("span"),
      point: element("input", {
        type: "number",
        id: "point",
        min: 0,
        max: this.body.content.points - 1,
        step: 1,
        placeholder: "number",
      }),
      values: element("div", { className: "values", id: "values", "aria-live": "polite" }),
    });
    for (const { id, label } of this.quantities) p.field.add(new Option(label, id));
    const named = (text, ...inputs) => element("label", {}, element("span", { textContent: text }), ...inputs);
    const controls = element(
      "div",
      { className: "controls" },
      named("colour", p.field),
      named("colours span", p.colours),
      named("displacements ×", p.scale, p.slider),
      ...this.#switches(named),
      named(this.body.points ? "point" : "cell", p.point),
    );
    const reset = element("button", { type: "button", textContent: "Reset view" });
    const bar = element("div", { className: "colour-bar" }, p.low, p.bar, p.high);
    for (const part of [p.play, p.step]) part.hidden = last === 0;
    place.append(
      element(
        "div",
        { className: "stage" },
        p.canvas,
        element("div", { className: "player" }, p.play, p.step, reset),
        p.stepWords,
        bar,
        p.note,
      ),
      element("div", { className: "side" }, controls, p.values),
    );
    p.step.addEventListener("input", () => this.show(Number(p.step.value)));
    p.play.addEventListener("click", () => this.#togglePlay());
    p.field.addEventListener("change", () =>
      this.#choose(
        this.quantities.find(({ id }) => id === p.field.value),
        true,
      ),
    );
    p.colours.addEventListener("change", () => this.#draw());
    p.scale.addEventListener("change", () => this.#rescale(Math.max(Number(p.scale.value) || 0, 0)));
    p.slider.addEventListener("input", () => this.#rescale((this.#firstScale() * Number(p.slider.value)) / 25));
    p.point.addEventListener("change", () =>
      this.#pick(p.point.value === "" ? null : this.body.cellOf(Number(p.point.value))),
    );
    reset.addEventListener("click", () => this.scene && this.#frameBody());
  }

  /** Check boxes and the cut, where the body has bonds to draw or an inside. */
  #switches(named) {
    const made = [];
    const p = this.parts;
    if (this.body.bonds) {
      p.bonds = element("input", { type: "checkbox", id: "bonds", checked: true });
      p.bonds.addEventListener("change", () => this.#draw());
      made.push(named("broken bonds", p.bonds));
    }
    if (this.body.dimension === 3) {
      p.clear = element("input", { type: "checkbox", id: "clear" });
      p.clear.addEventListener("change", () => this.#draw());
      p.axis = element(
        "select",
        { id: "axis", "aria-label": "axis of the cut" },
        ...[...AXES].map((axis) => new Option(axis, axis)),
      );
      p.cut = element("input", {
        type: "range",
        id: "cut",
        "aria-label": "place of the cut",
        min: 0,
        max: 100,
        value: 100,
      });
      for (const input of [p.axis, p.cut]) input.addEventListener("input", () => this.#draw());
      made.push(named("see through", p.clear), named("cut across", p.axis, p.cut));
    }
    return made;
  }

  #choose(quantity, isDrawn = false) {
    this.quantity = quantity;
    this.parts.field.value = quantity.id;
    if (isDrawn) this.#draw();
  }

  #rescale(scale) {
    this.scale = scale;
    this.parts.scale.value = Number(scale.toPrecision(3));
    this.parts.slider.value = (25 * scale) / this.#firstScale();
    this.#draw();
  }

  #draw() {
    const { body, frame, parts } = this;
    const { step, load, broken } = body.frames[frame];
    parts.stepWords.textContent = [`step ${step}`, load, broken ? `${broken} broken bond${broken === 1 ? "" : "s"}` : ""]
      .filter(Boolean)
      .join(" · ");
    parts.step.setAttribute("aria-valuetext", parts.stepWords.textContent);
    const values = this.quantity.values(frame);
    const span = this.#span(values);
    this.#label(span);
    if (this.scene) {
      const hidden = this.#hidden();
      this.scene.setCells(
        body.cells.positions(frame, this.displacements, body.loose(frame), this.scale),
        this.#colours(values, span),
        body.cells.triangles(frame, (cell) => hidden[cell]),
      );
      this.scene.setBonds(
        parts.bonds?.checked ? body.brokenBonds(frame, this.displacements, this.scale) : new Float32Array(),
      );
      this.scene.setSeeThrough(Boolean(parts.clear?.checked));
      this.#mark();
      this.scene.draw();
    }
    this.#tell();
  }

  /** Lowest and highest value that the colours tell apart, and whether values lie above. */
  #span(values) {
    const frames = this.parts.colours.value === "all" ? this.body.frames.map((_, frame) => frame) : [this.frame];
    let low = Math.min(...frames.map((frame) => this.quantity.low(frame)));
    let high = Math.max(...frames.map((frame) => this.quantity.high(frame)));
    if (this.quantity.map === "damage") [low, high] = [0, Math.max(high, 1e-9)];
    if (this.quantity.map === "signed") [low, high] = [-Math.max(-low, high), Math.max(-low, high)];
    const most = Math.max(...frames.map((frame) => this.quantity.usual(frame)));
    const isCut = this.quantity.map === "plain" && low >= 0 && high > FAR * most && most > 0;
    return { low, high: isCut ? most : high, isCut };
  }

  #label({ low, high, isCut }) {
    const { unit } = this.quantity;
    const { name, size } = unitFor(Math.max(Math.abs(low), Math.abs(high)), unit);
    this.parts.bar.style.background = gradient(this.quantity.map);
    this.parts.low.textContent = plain(low / size, 3);
    this.parts.high.textContent = `${isCut ? "≥ " : ""}${plain(high / size, 3)} ${name}`;
  }

  #colours(values, { low, high }) {
    const { corners } = this.body.cells;
    const colours = new Float32Array(3 * corners * this.body.count);
    for (let cell = 0, at = 0; cell < this.body.count; cell++) {
      const rgb = colour(this.quantity.map, high > low ? (values[cell] - low) / (high - low) : 0);
      for (let corner = 0; corner < corners; corner++, at += 3) colours.set(rgb, at);
    }
    return colours;
  }

  /** Whether each cell lies beyond the cut. */
  #hidden() {
    const { cut, axis } = this.parts;
    const hidden = new Uint8Array(this.body.count);
    if (!cut || Number(cut.value) >= 100) return hidden;
    const c = AXES.indexOf(axis.value);
    const along = Float64Array.from({ length: this.body.count }, (_, cell) => this.body.centres[3 * cell + c]);
    const low = along.reduce((least, value) => Math.min(least, value), Infinity);
    const high = along.reduce((most, value) => Math.max(most, value), -Infinity);
    return Uint8Array.from(along, (value) => value > low + ((high - low) * (Number(cut.value) + 1e-6)) / 100);
  }

  #pick(cell) {
    this.chosen = cell === null || cell < 0 ? null : cell;
    this.parts.point.value = this.chosen === null ? "" : (this.body.points?.[this.chosen] ?? this.chosen);
    this.#mark();
    this.scene?.draw();
    this.#tell();
  }

  #mark() {
    const at = this.chosen;
    const place = (c) => this.body.centres[3 * at + c] + this.scale * this.displacements[3 * at + c];
    this.scene?.setMark(at === null ? null : [place(0), place(1), place(2)]);
  }

  /** The values of the chosen point. */
  #tell() {
    const note = "Click the body, or type a number, to read the values of a point.";
    this.parts.values.replaceChildren(
      this.chosen === null
        ? element("p", { className: "note", textContent: note })
        : pointTable(this.body, this.quantities, this.chosen, this.frame),
    );
  }

  #togglePlay() {
    if (this.timer) return this.#stop();
    if (this.frame === this.body.frames.length - 1) this.show(0);
    this.parts.play.textContent = "❚❚ Pause";
    this.timer = setInterval(() => {
      if (this.frame < this.body.frames.length - 1) this.show(this.frame + 1);
      else this.#stop();
    }, PAUSE);
  }

  #stop() {
    clearInterval(this.timer);
    this.timer = null;
    this.parts.play.textContent = "▶ Play";
  }
}
