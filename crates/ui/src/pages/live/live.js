// @ts-check
// A sensor at work: each photodiode's trace where it is on the nail, the forces in the cone, contact and switch, how the
// streams are. The server decimates; a message has the last bins of each trace by their number.

import { at, enter, made, say, tell } from "./common.js";
import { drawField, drawMeasured, place, ready } from "./draw.js";

/** @typedef {[number, number, number]} Bin */
/** @typedef {{name: string, at: [number, number] | null, trace: Bin[]}} Photodiode */
/** @typedef {{name: string | null, photodiodes: Photodiode[], columns: string[], answer: (number | null)[], contact: string |
 *   null, pressed: boolean | null, state: string, force_state: string | null, rows: number, lost: number, spoilt: number,
 *   rate_hz: number | null, time_s: number | null}} Finger */
/** @typedef {{bin_s: number, fingers: Finger[], work_us: [number, number] | null}} Message */

/** How much of a trace is shown, seconds. */
const SHOWN_S = 10;
/** The cone that is shown: pressing and friction of 5.2.2. */
const [FZ_MAX_N, MU] = [3, 0.75];
/** A message this old, milliseconds, is old. */
const OLD_MS = 2000;

/** @type {Message | null} */
let latest = null;
let heard_ms = 0;
let changed = false;
/** Of each finger and photodiode, the bins that are kept. @type {Map<string, Map<number, Bin>>} */
const kept = new Map();
/** @type {{nail: HTMLCanvasElement, cone: HTMLCanvasElement, lamps: HTMLElement, words: HTMLElement}[]} */
let places = [];

/** @param {Message} message */
function build(message) {
  places = [];
  at("fingers").replaceChildren(...message.fingers.map((finger) => {
    const section = document.createElement("section");
    const canvas = (/** @type {string} */ label) => {
      const one = document.createElement("canvas");
      one.setAttribute("role", "img");
      one.setAttribute("aria-label", label);
      return one;
    };
    const own = {
      nail: canvas("Traces of the photodiodes, each where it is on the nail"),
      cone: canvas("The force: sideways and upwards its shear, its pressing by colour and on the bar"),
      lamps: made("p", "", "lamps"),
      words: made("p", ""),
    };
    places.push(own);
    const right = document.createElement("div");
    right.append(own.lamps, own.cone, own.words);
    section.append(made("h2", finger.name ?? "Sensor"), own.nail, right);
    return section;
  }));
}

/** @param {Message} message */
function hear(message) {
  if (!latest || places.length !== message.fingers.length) build(message);
  latest = message;
  heard_ms = performance.now();
  changed = true;
  message.fingers.forEach((finger, f) => {
    for (const one of finger.photodiodes) {
      const key = `${f} ${one.name}`;
      const bins = kept.get(key) ?? new Map();
      kept.set(key, bins);
      for (const bin of one.trace) bins.set(bin[0], bin);
      const last = one.trace.length ? one.trace[one.trace.length - 1][0] : 0;
      for (const bin of bins.keys()) if (bin <= last - SHOWN_S / message.bin_s || bin > last) bins.delete(bin);
    }
  });
}

/** @param {CanvasRenderingContext2D} to @param {string} name @param {Bin[]} bins @param {number} last @param {number} count
 * @param {[number, number, number, number]} box */
function trace(to, name, bins, last, count, [left, top, width, height]) {
  const [low, high] = bins.reduce(([l, h], bin) => [Math.min(l, bin[1]), Math.max(h, bin[2])], [Infinity, -Infinity]);
  const span = Math.max(high - low, 0.02);
  const y = (/** @type {number} */ v) => top + height - 4 - ((v - (high + low - span) / 2) / span) * (height - 22);
  to.strokeStyle = "#bbb";
  to.lineWidth = 1;
  to.strokeRect(left, top, width, height);
  to.fillStyle = "#000";
  to.fillText(bins.length ? `${name}  ${low.toFixed(2)} to ${high.toFixed(2)} V` : `${name}  nothing`, left + 4, top + 12);
  to.fillStyle = "#00336f";
  const step = width / count;
  for (const [bin, least, most] of bins) {
    const x = left + width - (last - bin + 1) * step;
    to.fillRect(x, y(most), Math.max(1, step), Math.max(1.5, y(least) - y(most)));
  }
}

/** @param {Finger} finger @param {number} f @param {HTMLCanvasElement} canvas @param {number} bin_s */
function nail(finger, f, canvas, bin_s) {
  const { to, width, height } = ready(canvas);
  to.font = "11px system-ui, sans-serif";
  to.textAlign = "left";
  const count = Math.round(SHOWN_S / bin_s);
  const lasts = finger.photodiodes.flatMap((one) => one.trace.slice(-1).map((bin) => bin[0]));
  const last = Math.max(0, ...lasts);
  const known = finger.photodiodes.every((one) => one.at);
  const rows = Math.ceil(finger.photodiodes.length / 2);
  const [w, h] = known ? [width / 3 - 8, height / 5] : [width / 2 - 8, height / rows - 6];
  finger.photodiodes.forEach((one, k) => {
    // Distal is up.
    const [u, v] = one.at ?? [0, 0];
    const x = known ? width / 2 + u * (width / 2 - w / 2 - 4) / 0.6 - w / 2 : 4 + (k % 2) * (width / 2);
    const y = known ? height / 2 - v * (height / 2 - h / 2 - 4) / 0.75 - h / 2 : 3 + Math.floor(k / 2) * (height / rows);
    const bins = [...(kept.get(`${f} ${one.name}`) ?? new Map()).values()];
    trace(to, one.name, bins, last, count, [x, y, w, h]);
  });
}

/** @param {Finger} finger @param {HTMLCanvasElement} canvas */
function cone(finger, canvas) {
  const { to, width, height } = ready(canvas);
  const on = place(width, height, FZ_MAX_N * MU, FZ_MAX_N);
  drawField(to, on, "cividis", FZ_MAX_N * MU);
  const [x, y, z] = ["Fx_N", "Fy_N", "Fz_N"].map((name) => finger.answer[finger.columns.indexOf(name)] ?? null);
  // A force of which a part is not known has no place.
  if (x !== null && y !== null && z !== null) drawMeasured(to, on, "cividis", [x, y, z], FZ_MAX_N);
}

/** @param {Finger} finger @param {HTMLElement} lamps @param {HTMLElement} words */
function lines(finger, lamps, words) {
  const all = [[`stream ${finger.state}`, finger.state !== "ok"]];
  if (finger.force_state) all.push([`force ${finger.force_state}`, finger.force_state !== "ok"]);
  if (finger.contact) all.push([finger.contact, finger.contact === "touch"]);
  if (finger.pressed !== null) all.push([finger.pressed ? "switch pressed" : "switch released", finger.pressed]);
  lamps.replaceChildren(...all.map(([text, on]) => made("span", String(text), on ? "on" : "")));
  const answer = finger.columns.map((name, k) => `${name} ${finger.answer[k]?.toFixed(2) ?? "not known"}`);
  const rate = finger.rate_hz === null ? "" : ` at ${finger.rate_hz.toFixed(0)} Hz`;
  words.textContent = `${answer.join(", ")}. ${finger.rows} rows${rate}, ${finger.lost} lost, ${finger.spoilt} spoilt.`;
}

function draw() {
  requestAnimationFrame(draw);
  if (!latest) return;
  if (performance.now() - heard_ms > OLD_MS) say("The server is silent; what is shown is old.");
  if (!changed) return;
  changed = false;
  const { bin_s, fingers, work_us } = latest;
  fingers.forEach((finger, f) => {
    nail(finger, f, places[f].nail, bin_s);
    cone(finger, places[f].cone);
    lines(finger, places[f].lamps, places[f].words);
  });
  const bad = fingers.filter((finger) => finger.state !== "ok");
  const text = bad.length ? bad.map((one) => `${one.name ?? "The sensor"} is ${one.state}`).join("; ") + "." : "Live.";
  if (at("state").textContent !== text) say(text);
  at("work").textContent = work_us ? `${work_us[0].toFixed(0)} µs a row, 99 in 100 within ${work_us[1].toFixed(0)} µs` : "";
}

tell(async () => {
  await enter();
  const news = new EventSource("api/live/state");
  news.onmessage = (event) => {
    const message = JSON.parse(event.data);
    if (message) hear(message);
  };
  news.onerror = () => say("The server is not heard; looking for it.");
  requestAnimationFrame(draw);
});
