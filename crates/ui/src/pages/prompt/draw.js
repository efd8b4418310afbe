// @ts-check
// What the page draws: ring, disc, bar with triangle and line, finger, the cone's map. Sizes are pixels of the page.

/** @typedef {[number, number, number]} Force */
/** @typedef {{width: number, height: number, centre_px: [number, number], px_per_n: number, bar_px: [number, number],
 *   bar_x: number, finger_px: number}} Place */

const CIVIDIS = ["00204d", "00336f", "39486b", "575c6d", "707173", "8a8779", "a69d75", "c4b56c", "e4cf5b", "ffea46"]
  .map((hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)));
const RING_PX = 24;
const DISC_PX = 11;
const BAR_PX = 26;
/** The ring is so much thicker for each newton that the pressing is off, and at most. */
const THICKER_PX = 12;
const THICKEST_PX = 18;

/** The colour of a part from 0 to 1. @param {string} map @param {number} part */
export function colour(map, part) {
  const x = Math.min(1, Math.max(0, part));
  if (map === "rainbow") return `hsl(${Math.round(240 * (1 - x))} 100% 45%)`;
  const at = Math.min(CIVIDIS.length - 2, Math.floor(x * (CIVIDIS.length - 1)));
  const share = x * (CIVIDIS.length - 1) - at;
  return `rgb(${CIVIDIS[at].map((one, k) => Math.round(one + share * (CIVIDIS[at + 1][k] - one))).join(" ")})`;
}

/** A canvas at the screen's own resolution. @param {HTMLCanvasElement} canvas */
export function ready(canvas) {
  const scale = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const [w, h] = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const to = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  to.setTransform(scale, 0, 0, scale, 0, 0);
  to.clearRect(0, 0, width, height);
  return { to, width, height };
}

/** Where forces are on the field. @param {number} width @param {number} height @param {number} shear_n @param {number}
 * scale_n @returns {Place} */
export function place(width, height, shear_n, scale_n) {
  const bar_x = width - 60;
  const half = Math.min(bar_x - 40, height) / 2 - RING_PX - 12;
  const [top, bottom] = [28, height - 28];
  return {
    width,
    height,
    centre_px: [Math.round((bar_x - 30) / 2), Math.round(height / 2)],
    px_per_n: Math.max(1, half / shear_n),
    bar_px: [bottom, (bottom - top) / scale_n],
    bar_x,
    finger_px: Math.max(40, height / 3),
  };
}

/** @param {Place} at @param {Force} force @returns {[number, number]} */
export const onField = (at, [fx, fy]) => [at.centre_px[0] + at.px_per_n * fx, at.centre_px[1] - at.px_per_n * fy];
/** @param {Place} at @param {Force} force */
export const onBar = (at, [, , fz]) => at.bar_px[0] + at.bar_px[1] * fz;

/** @param {CanvasRenderingContext2D} to @param {Place} at @param {string} map @param {number} shear_n */
export function drawField(to, at, map, shear_n) {
  const [x, y] = at.centre_px;
  to.strokeStyle = "#bbb";
  to.lineWidth = 1;
  to.beginPath();
  to.arc(x, y, at.px_per_n * shear_n, 0, 2 * Math.PI);
  to.moveTo(x - 8, y);
  to.lineTo(x + 8, y);
  to.moveTo(x, y - 8);
  to.lineTo(x, y + 8);
  to.stroke();
  const [bottom, per_n] = at.bar_px;
  const top = 28;
  for (let row = top; row < bottom; row += 1) {
    to.fillStyle = colour(map, (bottom - row) / (bottom - top));
    to.fillRect(at.bar_x, row, BAR_PX, 1.5);
  }
  to.fillStyle = "#000";
  to.font = "12px system-ui, sans-serif";
  to.textAlign = "left";
  for (let n = 0; n * per_n <= bottom - top + 1; n += 1) to.fillText(`${n}`, at.bar_x + BAR_PX + 14, bottom - n * per_n + 4);
  to.fillText("N", at.bar_x + BAR_PX + 14, 14);
}

/** The ring and the triangle. @param {CanvasRenderingContext2D} to @param {Place} at @param {string} map @param {Force}
 * force @param {Force | null} measured @param {number} scale_n */
export function drawPrompt(to, at, map, force, measured, scale_n) {
  const [x, y] = onField(at, force);
  const off_n = measured ? Math.abs(measured[2] - force[2]) : 0;
  const width = 5 + Math.min(THICKEST_PX, THICKER_PX * off_n);
  to.beginPath();
  to.arc(x, y, RING_PX, 0, 2 * Math.PI);
  to.strokeStyle = "#222";
  to.lineWidth = width + 2;
  to.stroke();
  to.strokeStyle = colour(map, -force[2] / scale_n);
  to.lineWidth = width;
  to.stroke();
  const bar = onBar(at, force);
  to.beginPath();
  to.moveTo(at.bar_x - 2, bar);
  to.lineTo(at.bar_x - 18, bar - 9);
  to.lineTo(at.bar_x - 18, bar + 9);
  to.closePath();
  to.fillStyle = "#000";
  to.fill();
}

/** The disc and the line. @param {CanvasRenderingContext2D} to @param {Place} at @param {string} map @param {Force}
 * force @param {number} scale_n */
export function drawMeasured(to, at, map, force, scale_n) {
  const [x, y] = onField(at, force);
  to.beginPath();
  to.arc(x, y, DISC_PX, 0, 2 * Math.PI);
  to.fillStyle = colour(map, -force[2] / scale_n);
  to.fill();
  to.strokeStyle = "#222";
  to.lineWidth = 1.5;
  to.stroke();
  const bar = onBar(at, force);
  for (const [style, width] of /** @type {[string, number][]} */ ([["#fff", 6], ["#000", 3]])) {
    to.strokeStyle = style;
    to.lineWidth = width;
    to.beginPath();
    to.moveTo(at.bar_x - 4, bar);
    to.lineTo(at.bar_x + BAR_PX + 8, bar);
    to.stroke();
  }
}

/** A finger from the side, its joints bent: J2, and J3 by two thirds of it. @param {CanvasRenderingContext2D} to @param
 * {Place} at @param {number} j2_deg */
export function drawFinger(to, at, j2_deg) {
  const unit = at.finger_px;
  let [x, y] = [at.centre_px[0] - 1.1 * unit, at.centre_px[1] - 0.3 * unit];
  let turn = 0;
  to.lineCap = to.lineJoin = "round";
  const line = [[x, y]];
  for (const [bend, length] of [[0, 0.9], [j2_deg, 0.6], [(2 / 3) * j2_deg, 0.45]]) {
    turn += (bend * Math.PI) / 180;
    x += unit * length * Math.cos(turn);
    y += unit * length * Math.sin(turn);
    line.push([x, y]);
  }
  for (const [style, width] of /** @type {[string, number][]} */ ([["#222", 0.32], ["#e8c4a8", 0.29]])) {
    to.strokeStyle = style;
    to.lineWidth = width * unit;
    to.beginPath();
    line.forEach(([px, py], k) => (k ? to.lineTo(px, py) : to.moveTo(px, py)));
    to.stroke();
  }
  // The nail.
  to.strokeStyle = "#b56576";
  to.lineWidth = 0.05 * unit;
  const [nx, ny] = [Math.sin(turn) * 0.13 * unit, -Math.cos(turn) * 0.13 * unit];
  const back = (/** @type {number} */ part) => /** @type {[number, number]} */ ([x - part * unit * Math.cos(turn) + nx, y - part * unit * Math.sin(turn) + ny]);
  to.beginPath();
  to.moveTo(...back(0.22));
  to.lineTo(...back(-0.05));
  to.stroke();
  to.lineCap = "butt";
}

/** The map of the cone: six layers of pressing, each of four rings and eight sectors. @param {HTMLCanvasElement} canvas
 * @param {string} map @param {string} cells @param {number[] | null} hole @param {number} fz_max @param {number} mu */
export function drawCone(canvas, map, cells, hole, fz_max, mu) {
  const { to, width, height } = ready(canvas);
  const [across, down, rings, sectors] = [3, 2, 4, 8];
  const radius = Math.min(width / across, (height - 8) / down) / 2 - 14;
  to.font = "11px system-ui, sans-serif";
  to.textAlign = "center";
  for (let layer = 0; layer < across * down; layer += 1) {
    const x = (width / across) * ((layer % across) + 0.5);
    const y = (height / down) * (Math.floor(layer / across) + 0.5) + 6;
    const share = Math.sqrt((layer + 0.5) / 6);
    for (let cell = 0; cell < rings * sectors; cell += 1) {
      const [out, turn] = [Math.floor(cell / sectors), cell % sectors];
      const angle = (/** @type {number} */ k) => ((turn + k) / sectors) * 2 * Math.PI - Math.PI / 2;
      to.beginPath();
      to.arc(x, y, (radius * (out + 1)) / rings, angle(0), angle(1));
      to.arc(x, y, (radius * out) / rings, angle(1), angle(0), true);
      to.closePath();
      if (cells[layer * rings * sectors + cell] === "1") {
        to.fillStyle = colour(map, share);
        to.fill();
      }
      to.strokeStyle = "#999";
      to.lineWidth = 0.7;
      to.stroke();
    }
    to.fillStyle = "#000";
    to.fillText(`to ${(fz_max * Math.sqrt((layer + 1) / 6)).toFixed(1)} N`, x, y - radius - 4);
    if (!hole) continue;
    const up = Math.min(5, Math.floor(6 * (hole[2] / fz_max) ** 2));
    if (up !== layer) continue;
    const most_n = -mu * hole[2];
    const [hx, hy] = most_n > 0 ? [x + (radius * hole[0]) / most_n, y - (radius * hole[1]) / most_n] : [x, y];
    to.lineWidth = 2;
    to.strokeStyle = "#d00";
    to.beginPath();
    to.arc(hx, hy, 6, 0, 2 * Math.PI);
    to.moveTo(hx - 9, hy);
    to.lineTo(hx + 9, hy);
    to.moveTo(hx, hy - 9);
    to.lineTo(hx, hy + 9);
    to.stroke();
  }
}
