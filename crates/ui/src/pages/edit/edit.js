// @ts-check
// The page of outlines: shows the nail that the server shows, hands keys and what a pointer does on, one after another.

import { at, enter, made, say, tell } from "./common.js";
import { KEYS, named, pressed } from "./keys.js";

/** @typedef {import("./keys.js").Press} Press */
/** @typedef {[number, number]} Point */
/** @typedef {{id: number, photo: string, number: number, of: number, why: string, doubtful: boolean, decision: string | null,
 *   view: {x: number, y: number, width: number, height: number} | null, points: Point[], corner: number | null, axis: Point[],
 *   length_px: number, width_px: number, axis_deg: number, fault: string | null, can_undo: boolean}} Nail */
/** @typedef {{revision: number, nail: Nail | null, is_first: boolean, accepted: number, rejected: number, doubtful_left: number,
 *   others_left: number, open: number, failed: string[], said: string, is_fault: boolean}} State */

/** A pointer this near to a corner takes it, CSS pixels. */
const NEAR_PX = 14;
/** After so long without a key it is worth to make the picture exactly, milliseconds. */
const REST_MS = 150;
/** Less than this is a click, not a drag. */
const CLICK_PX = 4;

/** @type {State | null} */
let state = null;
/** What the photograph's picture shows. @type {{key: string, image: ImageBitmap} | null} */
let photo = null;
let photoAsked = "";
let normalizedAt = -1;
let fetching = false;
/** Keys go one after another: each at the nail that was seen. @type {Promise<void>} */
let sent = Promise.resolve();
let gestures = 0;
/** @type {{id: number, corner: number | null, from: Point, moved: boolean, inside: boolean, waiting: boolean, by: Point} | null} */
let drag = null;

const field = /** @type {HTMLCanvasElement} */ (at("field"));
const normalized = /** @type {HTMLImageElement} */ (at("normalized"));

/** From the photograph's pixels to the canvas' CSS pixels. */
function scale() {
  const view = state && state.nail && state.nail.view;
  if (!view) return null;
  const [width, height] = [field.clientWidth, field.clientHeight];
  const px = Math.min(width / view.width, height / view.height);
  const [left, top] = [(width - px * view.width) / 2, (height - px * view.height) / 2];
  return {
    px, left, top, view,
    /** @param {Point} p @returns {Point} */
    to: ([x, y]) => [left + (x + 0.5 - view.x) * px, top + (y + 0.5 - view.y) * px],
    /** @param {Point} p @returns {Point} */
    from: ([x, y]) => [(x - left) / px + view.x - 0.5, (y - top) / px + view.y - 0.5],
  };
}

/** @param {Nail} nail */
const viewKey = (nail) => JSON.stringify([nail.photo, nail.view]);

function draw() {
  const dense = devicePixelRatio || 1;
  const [width, height] = [Math.round(field.clientWidth * dense), Math.round(field.clientHeight * dense)];
  if (field.width !== width || field.height !== height) [field.width, field.height] = [width, height];
  const on = /** @type {CanvasRenderingContext2D} */ (field.getContext("2d"));
  on.setTransform(dense, 0, 0, dense, 0, 0);
  on.clearRect(0, 0, width, height);
  const map = scale();
  const nail = state && state.nail;
  if (!map || !nail) return;
  if (photo && photo.key === viewKey(nail)) {
    on.drawImage(photo.image, map.left, map.top, map.px * map.view.width, map.px * map.view.height);
  }
  const rim = new Path2D();
  nail.points.map(map.to).forEach(([x, y], k) => (k ? rim.lineTo(x, y) : rim.moveTo(x, y)));
  rim.closePath();
  const axis = new Path2D();
  const [proximal, distal] = nail.axis.map(map.to);
  axis.moveTo(...proximal);
  axis.lineTo(...distal);
  const angle = Math.atan2(distal[1] - proximal[1], distal[0] - proximal[0]);
  for (const turn of [-0.5, 0.5]) {
    axis.moveTo(...distal);
    axis.lineTo(distal[0] - 12 * Math.cos(angle + turn), distal[1] - 12 * Math.sin(angle + turn));
  }
  const ink = nail.fault ? "#ff7a70" : nail.decision === "rejected" ? "#bbbbbb" : "#3dff8a";
  for (const [style, thick] of /** @type {[string, number][]} */ ([["#000000", 3.5], [ink, 1.5]])) {
    on.strokeStyle = style;
    on.lineWidth = thick;
    on.stroke(rim);
    on.stroke(axis);
  }
  if (nail.corner !== null && nail.points[nail.corner]) {
    const [x, y] = map.to(nail.points[nail.corner]);
    on.fillStyle = "#ffd400";
    on.strokeStyle = "#000000";
    on.lineWidth = 1.5;
    on.beginPath();
    on.arc(x, y, 6, 0, 2 * Math.PI);
    on.fill();
    on.stroke();
  }
}

/** The part of the photograph that is to be seen. */
async function fetchPhoto() {
  const nail = state && state.nail;
  if (!nail || !nail.view) return;
  const key = viewKey(nail);
  if (photoAsked === key) return;
  photoAsked = key;
  const answer = await fetch("api/edit/photo");
  if (!answer.ok) return;
  const image = await createImageBitmap(await answer.blob());
  if (state && state.nail && viewKey(state.nail) === key) photo = { key, image };
  draw();
}

/** The nail as it would come out: quickly while keys are pressed, then as it would; the latest is never left out. */
async function fetchNormalized() {
  if (fetching) return;
  fetching = true;
  let quick = true;
  while (state && state.nail && (normalizedAt !== state.revision || quick)) {
    quick = normalizedAt !== state.revision;
    normalizedAt = state.revision;
    if (!quick) {
      await new Promise((over) => setTimeout(over, REST_MS));
      if (normalizedAt !== state.revision) continue;
    }
    const answer = await fetch(quick ? "api/edit/rough" : "api/edit/normalized");
    const old = normalized.src;
    at("not").textContent = answer.ok ? "" : `Would be left out: ${await answer.text()}`;
    normalized.hidden = !answer.ok;
    if (answer.ok) normalized.src = URL.createObjectURL(await answer.blob());
    if (old) URL.revokeObjectURL(old);
  }
  fetching = false;
}

/** @param {State} now */
function hear(now) {
  state = now;
  const { nail } = now;
  const waits = now.open ? `Looking for nails on ${now.open} more photographs.` : "All nails were looked at; P goes back.";
  say(now.said || (nail ? "" : waits));
  at("state").className = now.is_fault ? "bad" : "";
  const open = now.open ? `, ${now.open} photographs to search` : "";
  at("left").textContent = `${now.accepted} accepted, ${now.rejected} no nails, ${now.doubtful_left} doubtful and ` +
    `${now.others_left} others left${open}`;
  const said = { accepted: ", accepted", rejected: ", not a nail" }[nail && nail.decision ? nail.decision : ""] || "";
  at("nail").textContent = nail ? `${nail.photo}, nail ${nail.number} of ${nail.of}${said}` : "No nail";
  at("why").textContent = nail ? nail.why : "";
  at("why").className = nail && nail.doubtful ? "doubt" : "";
  at("size").textContent = nail
    ? `${nail.length_px.toFixed(1)} px long, ${nail.width_px.toFixed(1)} px wide, ${nail.axis_deg.toFixed(1)}° clockwise from up`
    : "";
  if (!nail) {
    normalized.hidden = true;
    at("not").textContent = "";
  }
  const failed = now.failed.map((what) => made("li", `Left out: ${what}`, "bad"));
  if (at("failed").childElementCount !== failed.length) at("failed").replaceChildren(...failed);
  draw();
  fetchPhoto().catch(() => say("The photograph is not shown; the server is not heard."));
  fetchNormalized().catch(() => (fetching = false));
}

/** @param {Press} press */
function send(press) {
  const nail = state && state.nail ? state.nail.id : null;
  const body = JSON.stringify(nail === null ? press : { ...press, nail });
  sent = sent.then(async () => {
    try {
      const answer = await fetch("api/edit/key", { method: "POST", body });
      // Another nail is shown by now: what was meant for the one before is not done to it.
      if (!answer.ok && answer.status !== 409) say(`The server answered ${answer.status}.`);
    } catch {
      say("The key did not reach the server.");
    }
  });
  return sent;
}

/** @param {KeyboardEvent} event */
function key(event) {
  const target = /** @type {HTMLElement} */ (event.target);
  const single = /** @type {HTMLInputElement} */ (at("shortcuts")).checked;
  if (target === field && event.key === "Escape") {
    send({ key: "choose", corner: null });
    /** @type {HTMLElement} */ (document.querySelector("#decide button")).focus();
  } else if (target === field && event.key === "Tab" && single && state && state.nail) {
    send({ key: "corner", forwards: !event.shiftKey });
  } else if ((event.key === "Enter" || event.key === " ") && target.closest("button, summary, input")) {
    return;
  } else if (!single && target !== field) {
    return;
  } else if (event.key === "?") {
    const more = /** @type {HTMLDetailsElement} */ (at("more"));
    more.open = !more.open;
  } else {
    const press = pressed(event);
    if (!press) return;
    // What decides is meant once, however long the key is held.
    if (!(event.repeat && ["accept", "reject", "next", "previous", "another"].includes(press.key))) send(press);
  }
  event.preventDefault();
}

/** @param {PointerEvent} event @returns {Point} */
const place = (event) => {
  const box = field.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
};

/** @param {PointerEvent} event */
function down(event) {
  const [map, nail] = [scale(), state && state.nail];
  if (!map || !nail || event.button > 0) return;
  const from = place(event);
  const away = nail.points.map((p) => Math.hypot(map.to(p)[0] - from[0], map.to(p)[1] - from[1]));
  const nearest = away.indexOf(Math.min(...away));
  const corner = away[nearest] <= NEAR_PX ? nearest : null;
  gestures += 1;
  drag = { id: gestures, corner, from, moved: false, inside: within(map.from(from), nail.points), waiting: false, by: [0, 0] };
  field.setPointerCapture(event.pointerId);
}

/** @param {PointerEvent} event */
function move(event) {
  const map = scale();
  if (!drag || !map) return;
  const [x, y] = place(event);
  const by = /** @type {Point} */ ([x - drag.from[0], y - drag.from[1]]);
  drag.moved ||= Math.hypot(...by) > CLICK_PX;
  if (!drag.moved || (drag.corner === null && !drag.inside)) return;
  drag.by = /** @type {Point} */ (by.map((v) => v / map.px));
  follow(drag);
}

/** The latest place of a gesture, never two at once. @param {NonNullable<typeof drag>} one */
function follow(one) {
  if (one.waiting) return;
  one.waiting = true;
  const by = one.by;
  send({ key: "drag", gesture: one.id, corner: one.corner, by_px: by }).then(() => {
    one.waiting = false;
    if (one.by !== by) follow(one);
  });
}

/** @param {PointerEvent} event */
function up(event) {
  const map = scale();
  const one = drag;
  drag = null;
  if (!one || !map || one.moved) return;
  if (one.corner !== null) send({ key: "choose", corner: one.corner });
  else if (!one.inside) send({ key: "place", to_px: map.from(place(event)) });
}

/** @param {Point} p @param {Point[]} rim */
function within([x, y], rim) {
  let inside = false;
  rim.forEach(([xa, ya], k) => {
    const [xb, yb] = rim[(k + 1) % rim.length];
    if (ya > y !== yb > y && x < xa + ((y - ya) / (yb - ya)) * (xb - xa)) inside = !inside;
  });
  return inside;
}

document.addEventListener("keydown", key);
field.addEventListener("pointerdown", down);
field.addEventListener("pointermove", move);
field.addEventListener("pointerup", up);
field.addEventListener("pointercancel", () => (drag = null));
new ResizeObserver(draw).observe(field);
for (const button of document.querySelectorAll("button[data-press]")) {
  button.addEventListener("click", () => send(named(/** @type {HTMLElement} */ (button).dataset.press || "")));
}
for (const { says, shown, press } of KEYS) {
  const button = made("button", `${says} `);
  button.setAttribute("type", "button");
  button.append(made("kbd", shown));
  button.addEventListener("click", () => send(press));
  at("keys").append(button);
}

tell(async () => {
  await enter();
  const states = new EventSource("api/edit/state");
  states.onmessage = (event) => hear(JSON.parse(event.data));
  states.onerror = () => say("The server is not heard; looking for it.");
  field.focus();
});
