// Curves by uPlot. They may turn back (snap-back), so every curve has abscissas of its own.

import uPlot from "uplot";
import { element, styleColour } from "./dom.js";
import { plain } from "./units.js";

const HEIGHT = 300;
const NEAR = 30; // farthest point of which the values are told [CSS pixel]
const LINES = 6; // colours of the style; more curves take colours around the circle
const MOST_MARKS = 80; // more states are drawn as a line alone

const DECADES = {
  filter: (_, ticks) => {
    const powers = ticks.map((tick) => Math.round(Math.log10(tick)));
    const every = Math.ceil((Math.max(...powers) - Math.min(...powers)) / 8) || 1;
    return ticks.map((tick, i) => (Math.abs(tick / 10 ** powers[i] - 1) < 1e-9 && powers[i] % every === 0 ? tick : null));
  },
  values: (_, ticks) => ticks.map((tick) => (tick === null ? "" : tick.toExponential(0))),
};

/** Draws a curve of the page: { x: label, y: label, log, series: [{label, x, y}] }; returns how to mark a step. */
export function drawCurves(place, { title, x, y, log, series, steps }) {
  const told = element("p", { className: "note told", "aria-live": "polite" });
  const data = [null, ...series.map((curve) => [curve.x, curve.y])];
  const width = () => Math.max(place.clientWidth, 240);
  let marked = -1;
  const chart = new uPlot(
    {
      mode: 2,
      width: width(),
      height: HEIGHT,
      title,
      legend: { show: series.length > 1, live: false },
      cursor: { points: { show: false }, drag: { x: true, y: true }, dataIdx: () => null },
      scales: { x: { time: false, range: padded(data, 0) }, y: log ? { distr: 3 } : { range: padded(data, 1) } },
      axes: [axis(x), { ...axis(y), size: 64, ...(log ? DECADES : {}) }],
      series: [
        {},
        ...series.map((curve, i) => ({
          label: curve.label,
          stroke: () =>
            series.length > LINES ? `hsl(${(360 * i) / series.length} 55% 50%)` : styleColour(`--line-${i + 1}`),
          facets: [
            { scale: "x", auto: true },
            { scale: "y", auto: true },
          ],
          paths: (u, index) => draw(u, index, curve),
        })),
      ],
      hooks: {
        draw: [(u) => markStep(u, series, steps, marked)],
        setCursor: [(u) => (told.textContent = nearest(u, series, x, y, steps))],
      },
    },
    data,
    place,
  );
  place.append(told);
  new ResizeObserver(() => chart.setSize({ width: width(), height: HEIGHT })).observe(place);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => chart.redraw());
  return (step) => {
    marked = step;
    if (steps) chart.redraw(false);
  };
}

function axis(label) {
  return {
    label,
    stroke: () => styleColour("--ink"),
    grid: { stroke: () => styleColour("--grid") },
    ticks: { stroke: () => styleColour("--grid") },
  };
}

/** The whole range of all curves with some space around. */
function padded(data, which) {
  let [low, high] = [Infinity, -Infinity];
  for (const curve of data.slice(1)) {
    for (const value of curve[which]) {
      if (value === null) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  const space = 0.04 * (high - low || Math.abs(high) || 1);
  return (u, min, max) => (min === null || (min <= low && max >= high) ? [low - space, high + space] : [min, max]);
}

function draw(u, index, curve) {
  const { ctx } = u;
  const series = u.series[index];
  const places = curve.x.map((value, i) => (curve.y[i] === null ? null : placeOf(u, value, curve.y[i])));
  ctx.save();
  ctx.beginPath();
  ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
  ctx.clip();
  ctx.strokeStyle = ctx.fillStyle = series.stroke(u, index);
  ctx.lineWidth = 1.8 * devicePixelRatio;
  ctx.lineJoin = "round";
  ctx.setLineDash(curve.dashed ? [6 * devicePixelRatio, 4 * devicePixelRatio] : []);
  ctx.beginPath();
  let isDown = false;
  for (const place of places) {
    if (place) ctx[isDown ? "lineTo" : "moveTo"](...place);
    isDown = Boolean(place);
  }
  ctx.stroke();
  if (places.length <= MOST_MARKS) {
    for (const place of places.filter(Boolean)) disc(ctx, place, 2.6);
  }
  ctx.restore();
  return null;
}

function disc(ctx, [x, y], radius) {
  ctx.beginPath();
  ctx.arc(x, y, radius * devicePixelRatio, 0, 2 * Math.PI);
  ctx.fill();
}

function placeOf(u, x, y) {
  return [u.valToPos(x, "x", true), u.valToPos(y, "y", true)];
}

/** A ring at the state that the body shows. */
function markStep(u, series, steps, marked) {
  const at = steps ? steps.indexOf(marked) : -1;
  if (at < 0) return;
  u.ctx.save();
  u.ctx.strokeStyle = styleColour("--mark");
  u.ctx.lineWidth = 2.2 * devicePixelRatio;
  for (const [i, curve] of series.entries()) {
    if (curve.y[at] === null || !u.series[i + 1].show) continue;
    u.ctx.beginPath();
    u.ctx.arc(...placeOf(u, curve.x[at], curve.y[at]), 6 * devicePixelRatio, 0, 2 * Math.PI);
    u.ctx.stroke();
  }
  u.ctx.restore();
}

/** The values of the state that is nearest to the pointer. */
function nearest(u, series, x, y, steps) {
  let best = NEAR;
  let words = "";
  series.forEach((curve, s) => {
    if (!u.series[s + 1].show) return;
    curve.x.forEach((value, i) => {
      if (curve.y[i] === null) return;
      const away = Math.hypot(u.valToPos(value, "x") - u.cursor.left, u.valToPos(curve.y[i], "y") - u.cursor.top);
      if (away >= best) return;
      best = away;
      const step = steps ? `step ${steps[i]}: ` : "";
      words = `${step}${x} ${plain(value, 5)}, ${series.length > 1 ? curve.label : y} ${plain(curve.y[i], 5)}`;
    });
  });
  return words;
}
