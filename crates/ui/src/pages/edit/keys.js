// @ts-check
// What keys and buttons mean. The server knows what they do; this is only what they are called.

/** @typedef {{key: string, [more: string]: unknown}} Press */
/** @typedef {{keys: string[], says: string, shown: string, press: Press, strides?: boolean}} Meaning */

/** @param {string[]} keys @param {string} says @param {string} shown @param {Press} press @param {boolean} [strides] */
const key = (keys, says, shown, press, strides) => ({ keys, says, shown, press, strides });

/** @type {Meaning[]} */
export const KEYS = [
  key(["Enter"], "Accept, next", "Enter", { key: "accept" }),
  key(["x"], "Not a nail", "X", { key: "reject" }),
  key(["n"], "Next", "N", { key: "next" }),
  key(["p"], "Previous", "P", { key: "previous" }),
  key(["g"], "Snap to border", "G", { key: "snap" }),
  key(["u"], "Undo", "U", { key: "undo" }),
  key(["r"], "As at first", "R", { key: "reset" }),
  key(["ArrowLeft"], "Left", "←", { key: "move", by: [-1, 0] }, true),
  key(["ArrowRight"], "Right", "→", { key: "move", by: [1, 0] }, true),
  key(["ArrowUp"], "Up", "↑", { key: "move", by: [0, -1] }, true),
  key(["ArrowDown"], "Down", "↓", { key: "move", by: [0, 1] }, true),
  key(["+", "="], "Larger, corner out", "+", { key: "grow", by: [1, 1], stride: "usual" }, true),
  key(["-"], "Smaller, corner in", "-", { key: "grow", by: [-1, -1], stride: "usual" }, true),
  key(["*"], "Much larger", "*", { key: "grow", by: [1, 1], stride: "coarse" }, true),
  key(["/", "_"], "Much smaller", "/", { key: "grow", by: [-1, -1], stride: "coarse" }, true),
  key([".", ">"], "Longer", ".", { key: "grow", by: [1, 0] }, true),
  key([",", "<"], "Shorter", ",", { key: "grow", by: [-1, 0] }, true),
  key(["'", '"'], "Wider", "'", { key: "grow", by: [0, 1] }, true),
  key([";", ":"], "Narrower", ";", { key: "grow", by: [0, -1] }, true),
  key(["]", "}"], "Turn right", "]", { key: "turn", by: 1 }, true),
  key(["[", "{"], "Turn left", "[", { key: "turn", by: -1 }, true),
  key(["a"], "Other end distal", "A", { key: "flip" }),
  key(["t"], "Axis alone right", "T", { key: "turn_axis", by: 1 }),
  key(["T"], "Axis alone left", "Shift T", { key: "turn_axis", by: -1 }),
  key(["i"], "Insert corner", "I", { key: "insert" }),
  key(["Delete", "Backspace"], "Remove corner", "Del", { key: "remove" }),
  key(["d"], "Another nail here", "D", { key: "another" }),
  key(["z"], "All of the photograph", "Z", { key: "zoom" }),
];

/** What a key means, or nothing. @param {KeyboardEvent} event @returns {Press | null} */
export function pressed(event) {
  if (event.ctrlKey || event.metaKey) return null;
  const name = event.key;
  const found = KEYS.find((one) => one.keys.includes(name)) ||
    KEYS.find((one) => name.length === 1 && one.keys.includes(name.toLowerCase()));
  if (!found) return null;
  if (!found.strides) return found.press;
  // Of a sign that some keyboards have behind Shift, Shift is no part.
  const stride = found.press.stride || (event.shiftKey ? "coarse" : "usual");
  return { ...found.press, stride: event.altKey ? "fine" : stride };
}

/** Of a button. @param {string} name @returns {Press} */
export const named = (name) => /** @type {Meaning} */ (KEYS.find((one) => one.press.key === name)).press;
