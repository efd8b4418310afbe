// @ts-check
// A session of the sensor: traces laid out as on the nail, forces in the cone of friction, contact, switch, losses and
// latency. The server sends ten pictures a second, each of the whole window; one that is missed is not missed.

import { at, enter, made, say, tell } from "./common.js";

/** @typedef {{rows: number, lost: number, spoilt: number, rate_hz: number | null}} Counts */
/** @typedef {{p50_us: number, p99_us: number}} Latency */
/** @typedef {{name: string | null, photodiodes: string[], places: ([number, number] | null)[], answers: string[],
 *   has_switch: boolean, low: (number | null)[][], high: (number | null)[][], values: (number | null)[],
 *   contact: string | null, pressed: boolean | null, state: string, time_s: number | null}} Finger */
/** @typedef {{bin_s: number, pixels: number, fingers: Finger[], ended: boolean,
 *   cone: {fz_max_n: number, mu: number}, health: {work: Latency | null, arrival: Latency | null, counts: Counts[]}}} Picture */

/** Width and height of the nail's drawing and of one trace on it, CSS pixels. */
const NAIL = [560, 440];
const TRACE = [150, 74];
const CONE = 240;
/** @type {Map<string, {section: HTMLElement, nail: HTMLCanvasElement, cone: HTMLCanvasElement, words: HTMLElement,
 *   contact: HTMLElement, pressed: HTMLElement, counts: HTMLElement}>} */
const shown = new Map();
let held = false;

/** @param {number} width @param {number} height @param {string} label */
function canvas(width, height, label) {
  const one = document.createElement("canvas");
  const dense = Math.min(3, Math.max(1, devicePixelRatio));
  one.width = width * dense;
  one.height = height * dense;
  one.setAttribute("role", "img");
  one.setAttribute("aria-label", label);
  one.getContext("2d")?.scale(dense, dense);
  return one;
}

/** @param {string} name */
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim() || "black";

/** @param {Finger} finger */
function panel(finger) {
  const key = finger.name ?? "";
  const known = shown.get(key);
  if (known) return known;
  const section = document.createElement("section");
  const title = made("h2", finger.name ?? "The sensor");
  const nail = canvas(NAIL[0], NAIL[1], "Photodiodes over the last seconds, where they lie on the nail");
  const cone = canvas(CONE, CONE, "Forces in the cone of friction");
  const [contact, pressed] = [made("span", "", "lamp"), made("span", "", "lamp")];
  const [words, counts] = [made("p", "", "values"), made("p", "", "counts")];
  const side = document.createElement("div");
  const lamps = document.createElement("p");
  lamps.append(contact, " ", pressed);
  side.append(cone, lamps, words, counts);
  section.append(title, nail, side);
  at("fingers").append(section);
  const one = { section, nail, cone, words, contact, pressed, counts };
  shown.set(key, one);
  return one;
}

/** Least and largest of what is known. @param {(number | null)[][]} all @returns {[number, number] | null} */
function range(all) {
  let [low, high] = [Infinity, -Infinity];
  for (const trace of all) {
    for (const value of trace) {
      if (value === null) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  return low <= high ? [low, high] : null;
}

/** Where a photodiode's trace goes: on the nail, or in a row below where its place is not known.
 * @param {Finger} finger @param {number} k @returns {[number, number]} */
function corner(finger, k) {
  const place = finger.places[k];
  if (place) {
    const [u, v] = place;
    return [(NAIL[0] - TRACE[0]) / 2 + u * 330, (NAIL[1] - TRACE[1]) / 2 + 10 - v * 225];
  }
  return [(k % 3) * (TRACE[0] + 30) + 20, Math.floor(k / 3) * (TRACE[1] + 10) + 10];
}

/** @param {HTMLCanvasElement} on @param {Finger} finger @param {number} pixels */
function drawTraces(on, finger, pixels) {
  const to = on.getContext("2d");
  if (!to) return;
  to.clearRect(0, 0, NAIL[0], NAIL[1]);
  to.font = "12px system-ui, sans-serif";
  if (finger.places.some(Boolean)) {
    to.strokeStyle = colour("--line");
    to.beginPath();
    to.ellipse(NAIL[0] / 2, NAIL[1] / 2, NAIL[0] / 2 - 2, NAIL[1] / 2 - 2, 0, 0, 2 * Math.PI);
    to.stroke();
  }
  // One scale for all: the widest of them fills its place.
  const spans = finger.low.map((low, k) => range([low, finger.high[k]]));
  const span = Math.max(1e-3, ...spans.map((one) => (one ? one[1] - one[0] : 0)));
  finger.photodiodes.forEach((name, k) => {
    const [x, y] = corner(finger, k);
    to.strokeStyle = colour("--line");
    to.strokeRect(x, y, TRACE[0], TRACE[1]);
    const own = spans[k];
    to.fillStyle = colour("--text");
    to.fillText(own ? `${name}  ${own[0].toFixed(3)} to ${own[1].toFixed(3)} V` : `${name}  not known`, x + 3, y - 3);
    if (!own) return;
    const middle = (own[0] + own[1]) / 2;
    const line = (/** @type {number} */ volts) => y + TRACE[1] / 2 - ((volts - middle) / span) * (TRACE[1] - 8);
    to.strokeStyle = colour("--trace");
    to.beginPath();
    const first = pixels - finger.low[k].length;
    finger.low[k].forEach((low, n) => {
      const high = finger.high[k][n];
      if (low === null || high === null) return;
      const column = x + ((first + n + 0.5) / pixels) * TRACE[0];
      to.moveTo(column, line(low) + 0.6);
      to.lineTo(column, line(high) - 0.6);
    });
    to.stroke();
  });
}

/** @param {HTMLCanvasElement} on @param {Finger} finger @param {Picture["cone"]} cone */
function drawForces(on, finger, { fz_max_n, mu }) {
  const to = on.getContext("2d");
  if (!to) return;
  to.clearRect(0, 0, CONE, CONE);
  const value = (/** @type {string} */ name) => finger.values[finger.answers.indexOf(name)] ?? null;
  const [x, y, z] = ["Fx_N", "Fy_N", "Fz_N"].map(value);
  if (z === null) return;
  const rim = Math.max(fz_max_n, -z);
  const middle = CONE / 2;
  const scale = (middle - 12) / (mu * rim);
  const ring = (/** @type {number} */ newtons, /** @type {string} */ name) => {
    to.strokeStyle = colour(name);
    to.beginPath();
    to.arc(middle, middle, Math.max(0, mu * newtons * scale), 0, 2 * Math.PI);
    to.stroke();
  };
  ring(rim, "--line");
  // Shear that friction holds at this pressing.
  ring(Math.max(0, -z), "--trace");
  to.beginPath();
  to.moveTo(middle - 6, middle);
  to.lineTo(middle + 6, middle);
  to.moveTo(middle, middle - 6);
  to.lineTo(middle, middle + 6);
  to.stroke();
  if (x === null || y === null) return;
  to.fillStyle = colour("--text");
  to.beginPath();
  to.arc(middle + x * scale, middle - y * scale, 6, 0, 2 * Math.PI);
  to.fill();
}

/** @param {HTMLElement} lamp @param {string} text @param {boolean} lit */
function light(lamp, text, lit) {
  lamp.textContent = text;
  lamp.classList.toggle("lit", lit);
}

/** @param {Picture} picture @param {number} k */
function show({ fingers, health, pixels, cone }, k) {
  const [finger, counts] = [fingers[k], health.counts[k]];
  const one = panel(finger);
  drawTraces(one.nail, finger, pixels);
  drawForces(one.cone, finger, cone);
  one.cone.hidden = !finger.answers.includes("Fz_N");
  const unit = (/** @type {string} */ name) => name.replace("_N", " N").replace("_deg", "\u00b0");
  const values = finger.answers.map((name, k) => {
    const value = finger.values[k] ?? null;
    const [what, in_] = unit(name).split(" ");
    return value === null ? `${what} not known` : `${what} ${value.toFixed(2)}${in_ ? " " + in_ : ""}`;
  });
  one.words.textContent = values.join(", ");
  light(one.contact, finger.contact ?? "", finger.contact === "touch");
  light(one.pressed, finger.has_switch ? (finger.pressed ? "switch pressed" : "switch released") : "", !!finger.pressed);
  const rate = counts?.rate_hz ? ` at ${counts.rate_hz.toPrecision(4)} Hz` : "";
  const rows = counts ? `${counts.rows} rows${rate}, ${counts.lost} lost, ${counts.spoilt} spoilt` : "";
  one.counts.textContent = [finger.state && `source ${finger.state}`, rows].filter(Boolean).join("; ");
  one.section.classList.toggle("bad", !["", "ok"].includes(finger.state));
}

/** @param {Picture} picture */
function draw(picture) {
  picture.fingers.forEach((_, k) => show(picture, k));
  const { work, arrival } = picture.health;
  const parts = [picture.ended ? "The session is over." : picture.fingers.length ? "Live." : "Waiting for samples."];
  if (work) parts.push(`Work per row ${work.p50_us.toFixed(0)} \u00b5s, 99 of 100 within ${work.p99_us.toFixed(0)} \u00b5s.`);
  if (arrival) parts.push(`Arrival within ${(arrival.p99_us / 1000).toFixed(1)} ms for 99 of 100.`);
  parts.push(`The traces are ${(picture.pixels * picture.bin_s).toFixed(0)} s long, all on one scale.`);
  say(parts.join(" "));
}

at("hold").addEventListener("click", () => {
  held = !held;
  at("hold").setAttribute("aria-pressed", String(held));
});
tell(async () => {
  await enter();
  const pictures = new EventSource("api/live");
  pictures.onmessage = (event) => {
    const picture = /** @type {Picture} */ (JSON.parse(event.data));
    if (!held && picture.fingers) draw(picture);
    if (picture.ended) pictures.close();
  };
  pictures.onerror = () => say("The server does not answer; the pictures are old.");
});
