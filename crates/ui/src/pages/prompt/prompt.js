// @ts-check
// The prompter's page: draws what is prompted where it will be when the frame is seen, says what it drew and when, and
// hands keys on. The server decides; this page only freezes at once when a key pauses.

import { at, enter, made, say, tell } from "./common.js";
import { isSet, server_s, shown, synchronize, uncertainty_s } from "./clock.js";
import { drawCone, drawField, drawFinger, drawMeasured, drawPrompt, onBar, onField, place, ready } from "./draw.js";

/** @typedef {import("./draw.js").Force} Force */
/** @typedef {{from_s: number, to_s: number, rows: number[][]}} Piece */
/** @typedef {{place: number, count: number, name: string, text: string, kind: string, collects: boolean, session: number,
 *   at_s: number, seconds: number, followed_n: number | null}} Step */
/** @typedef {{now_s: number, phase: string, why: string, step: Step | null, checks: {check: string, passed: boolean, says:
 *   string}[], ahead: Piece[], scale_n: number, fz_max_n: number, mu: number, cover: {rows: number, visited: number,
 *   cells: string, hole_n: number | null, hole_at_n: number[] | null}, extra: string | null, frames: number[]}} State */

/** Frames are sent so often, milliseconds, and so many are kept where the server does not take them. */
const SEND_MS = 400;
const MOST_KEPT = 450;
/** The time is asked for so often, milliseconds. */
const CLOCK_MS = 10000;
/** A state this old, seconds, is no state. */
const OLD_S = 3;

/** @type {State | null} */
let state = null;
let state_ms = 0;
/** @type {{force: Force, time_s: number} | null} */
let measured = null;
/** Where a key of this page has stopped the ring, until the server says so. @type {{time_s: number, sent: boolean} | null} */
let frozen = null;
/** @type {object[]} */
let unsent = [];
let sending = false;
let frame = 0;
let last_ms = 0;
let last_s = 0;
/** Times between frames, milliseconds, the latest. @type {number[]} */
const intervals = [];
let shownClock = "";

const field = /** @type {HTMLCanvasElement} */ (at("field"));
const cone = /** @type {HTMLCanvasElement} */ (at("cone"));
const input = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ (at(id));
const colours = /** @type {HTMLSelectElement} */ (at("colours"));

/** What is prompted at a time: a force, an angle, nothing. @param {number} time_s */
function prompted(time_s) {
  const t_s = frozen ? Math.min(time_s, frozen.time_s) : time_s;
  let piece = null;
  for (const one of state ? state.ahead : []) if (one.from_s <= t_s) piece = one;
  if (!piece || !piece.rows[0].length) return null;
  const steps = piece.rows.length - 1;
  const x = steps ? Math.min(steps, Math.max(0, ((t_s - piece.from_s) / (piece.to_s - piece.from_s)) * steps)) : 0;
  const k = Math.min(Math.floor(x), Math.max(0, steps - 1));
  const [one, two] = [piece.rows[k], piece.rows[Math.min(k + 1, steps)]];
  return one.map((value, c) => value + (x - k) * (two[c] - value));
}

/** The screen's own time between two frames, milliseconds. */
function interval() {
  const sorted = [...intervals].sort((a, b) => a - b);
  return sorted.length ? sorted[Math.floor(sorted.length / 2)] : 1000 / 60;
}

/** @param {number} now_ms */
function draw(now_ms) {
  requestAnimationFrame(draw);
  if (!state || !isSet() || document.hidden) return;
  const usual = interval();
  const passed = last_ms ? now_ms - last_ms : usual;
  last_ms = now_ms;
  const dropped = Math.max(0, Math.round(passed / usual) - 1);
  if (passed > 0 && passed < 100) {
    intervals.push(passed);
    if (intervals.length > 60) intervals.shift();
  }
  // It is seen a frame later.
  const time_s = server_s(now_ms + usual);
  const text = shown(time_s);
  if (text !== shownClock) at("clock").textContent = shownClock = text;
  if ((performance.now() - state_ms) / 1000 > OLD_S) {
    say("The server is silent; what is shown is old.");
    ready(field);
    return;
  }
  last_s = time_s;
  const map = colours.value;
  const { to, width, height } = ready(field);
  const shear_n = Math.max(state.mu * state.fz_max_n, 0.75 * state.scale_n);
  const on = place(width, height, shear_n, state.scale_n);
  const prompt = prompted(time_s);
  const force = prompt && prompt.length === 3 ? /** @type {Force} */ (prompt) : null;
  const bend = prompt && prompt.length === 1 ? prompt[0] : null;
  drawField(to, on, map, state.mu * state.fz_max_n);
  if (bend !== null) drawFinger(to, on, bend);
  if (force) drawPrompt(to, on, map, force, measured && measured.force, state.scale_n);
  if (measured) drawMeasured(to, on, map, measured.force, state.scale_n);
  if (input("digits").checked) numbers(force, bend);
  const short = (/** @type {number} */ value) => Math.round(1e6 * value) / 1e6;
  unsent.push({
    n: frame,
    time_s: short(time_s),
    uncertainty_s: short(uncertainty_s()),
    dropped,
    centre_px: on.centre_px,
    px_per_n: on.px_per_n,
    bar_px: on.bar_px,
    prompt_n: force,
    ring_px: force && onField(on, force),
    triangle_px: force && onBar(on, force),
    bend_deg: bend,
    finger_px: on.finger_px,
    force_s: measured && measured.time_s,
    disc_px: measured && onField(on, measured.force),
    line_px: measured && onBar(on, measured.force),
  });
  frame += 1;
}

/** @param {Force | null} force @param {number | null} bend */
function numbers(force, bend) {
  const three = (/** @type {Force} */ one) => one.map((n) => n.toFixed(2).padStart(6)).join(" ");
  const asked = force ? `prompted ${three(force)} N` : bend !== null ? `prompted J2 ${bend.toFixed(1)} degrees` : "prompted -";
  const is = measured ? `measured ${three(measured.force)} N` : "measured -";
  at("numbers").textContent = `${asked}\n${is}`;
}

async function send() {
  if (sending || !unsent.length) return;
  sending = true;
  const frames = unsent.splice(0, MOST_KEPT);
  try {
    const answer = await fetch("api/prompt/frames", { method: "POST", body: JSON.stringify({ frames }) });
    if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
  } catch {
    unsent = [...frames, ...unsent].slice(-MOST_KEPT);
  }
  sending = false;
}

/** @param {string} key @param {number} time_s */
async function press(key, time_s) {
  const pauses = (key === "go" || key === "hidden") && state && state.phase === "running" && !frozen;
  // No frame that was drawn already may be later than the stop.
  const stop_s = Math.max(time_s, last_s);
  if (pauses) frozen = { time_s: stop_s, sent: false };
  try {
    const body = JSON.stringify({ key, time_s: stop_s });
    await fetch("api/prompt/key", { method: "POST", body, keepalive: true });
  } catch {
    say("The key did not reach the server.");
  }
  if (frozen) frozen.sent = true;
}

/** @param {State} now */
function hear(now) {
  const before = state;
  state = now;
  state_ms = performance.now();
  if (frozen && (now.phase !== "running" || frozen.sent)) frozen = null;
  const ends = now.phase === "done" || now.phase === "over";
  const step = ends ? null : now.step;
  const { cover } = now;
  const words = {
    waiting: step && step.kind === "ask" ? "Read, then Space." : "Space begins.",
    running: step && step.kind === "check" ? "Checking." : step && step.collects ? "Collecting." : "Practising.",
    paused: "Paused; Space goes on.",
    stalled: "Stopped:",
    done: "Done: Esc closes.",
    over: "Over; this page can be closed.",
  }[now.phase];
  const why = now.why ? ` ${now.why}.` : "";
  if (!before || before.phase !== now.phase || before.why !== now.why || before.step?.place !== now.step?.place) say(`${words}${why}`);
  at("step").textContent = step ? `${step.place + 1} of ${step.count}: ${step.name}` : "Done";
  at("text").textContent = step ? step.text : now.extra ? `${now.extra}: E begins it.` : "";
  const lines = now.checks.map((one) => made("li", `${one.check}: ${one.says}`, one.passed ? "passed" : ""));
  at("checks").replaceChildren(...lines);
  const moves = now.phase === "running" && step && (step.kind === "force" || step.kind === "bend");
  at("go").firstChild.textContent = moves ? "Pause " : now.phase === "paused" ? "Go on " : "Start ";
  at("extra").hidden = !now.extra;
  for (const id of ["go", "reset", "skip"]) at(id).hidden = ends;
  at("stop").firstChild.textContent = ends ? "Close " : "Stop and keep ";
  at("cover").textContent = `${Math.floor(100 * cover.visited)} % of the cone, ${cover.rows} rows` +
    (cover.hole_n === null ? "" : `; largest hole ${cover.hole_n.toFixed(2)} N`);
  const left = step && step.seconds ? `${Math.max(0, step.seconds - step.at_s).toFixed(0)} s left` : "";
  const error = step && step.followed_n !== null ? `, ${step.followed_n.toFixed(2)} N off (RMS)` : "";
  at("followed").textContent = left + error;
  at("frames").textContent = `${now.frames[0]} frames shown, ${now.frames[1]} dropped`;
  if (!before || before.cover.cells !== cover.cells || before.cover.hole_n !== cover.hole_n) map();
}

function map() {
  if (state) drawCone(cone, colours.value, state.cover.cells, state.cover.hole_at_n, state.fz_max_n, state.mu);
}

function help() {
  const hidden = !at("keys-help").hidden;
  at("keys-help").hidden = hidden;
  at("help").setAttribute("aria-expanded", String(!hidden));
}

/** @type {Record<string, string>} */
const KEYS = { " ": "go", r: "reset", n: "skip", e: "extra", Escape: "stop" };

/** @param {KeyboardEvent} event */
function key(event) {
  if (event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
  const target = /** @type {HTMLElement} */ (event.target);
  // Space on a button is that button's; letters choose in a list.
  if (event.key === " " && target.closest("button, input, select")) return;
  if (event.key !== "Escape" && (target.closest("select") || !input("shortcuts").checked)) return;
  const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (KEYS[name]) press(KEYS[name], server_s(event.timeStamp));
  else if (name === "?") help();
  else if (name === "d") input("digits").click();
  else if (name === "c") {
    colours.selectedIndex = 1 - colours.selectedIndex;
    map();
  } else return;
  event.preventDefault();
}

function leave() {
  send();
  press("hidden", last_s);
}

document.addEventListener("keydown", key);
document.addEventListener("visibilitychange", () => {
  last_ms = 0;
  if (document.hidden) leave();
});
addEventListener("pagehide", leave);
addEventListener("resize", map);
for (const id of ["go", "reset", "skip", "extra", "stop"]) {
  at(id).addEventListener("click", (event) => press(id, server_s(event.timeStamp)));
}
at("help").addEventListener("click", help);
colours.addEventListener("change", map);
input("digits").addEventListener("change", () => {
  at("numbers").hidden = !input("digits").checked;
});

tell(async () => {
  await enter();
  await synchronize();
  setInterval(() => synchronize().catch(() => {}), CLOCK_MS);
  setInterval(send, SEND_MS);
  const states = new EventSource("api/prompt/state");
  states.onmessage = (event) => hear(JSON.parse(event.data));
  states.onerror = () => say("The server is not heard; looking for it.");
  new EventSource("api/prompt/force").onmessage = (event) => {
    const [time_s, fx, fy, fz] = JSON.parse(event.data);
    if (fz !== undefined) measured = { force: [fx, fy, fz], time_s };
  };
  requestAnimationFrame(draw);
});
