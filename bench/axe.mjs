// What axe-core finds on a page of lunula, in headless Chromium: violations of WCAG 2.2 A and AA.
//
//   npm pack axe-core@4.10.3 && tar xzf axe-core-*.tgz      makes package/axe.min.js here
//   lunula ui results &                                     prints the page's address
//   node bench/axe.mjs ADDRESS [PICTURE.png]                Node 22, or 20 with --experimental-websocket
//
// Exit status: 0 no violations, 1 some, which are printed.

import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [address, picture] = process.argv.slice(2);
const axe = readFileSync("package/axe.min.js", "utf8");
const profile = `--user-data-dir=${mkdtempSync(join(tmpdir(), "axe-"))}`;
const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--window-size=1200,800"];
const browser = spawn("chromium", [...flags, profile, "about:blank"], { stdio: ["ignore", "ignore", "pipe"] });
const port = await new Promise((found, failed) => {
  let said = "";
  browser.stderr.on("data", (text) => {
    said += text;
    const at = said.match(/DevTools listening on ws:\/\/[^:]+:(\d+)/);
    if (at) found(at[1]);
  });
  browser.on("error", failed);
});
const tabs = await (await fetch(`http://127.0.0.1:${port}/json`)).json();
const socket = new WebSocket(tabs.find((tab) => tab.type === "page").webSocketDebuggerUrl);
await new Promise((open) => socket.addEventListener("open", open));

let count = 0;
const waiting = new Map();
socket.addEventListener("message", ({ data }) => {
  const answer = JSON.parse(data);
  waiting.get(answer.id)?.(answer);
});
const call = (method, params = {}) =>
  new Promise((answered) => {
    waiting.set(++count, (answer) => answered(answer.result));
    socket.send(JSON.stringify({ id: count, method, params }));
  });
const pause = (ms) => new Promise((over) => setTimeout(over, ms));

await call("Page.enable");
await call("Page.navigate", { url: address });
// A page of a session is never done loading.
await pause(6000);
await call("Runtime.evaluate", { expression: axe });
const tags = JSON.stringify(["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]);
const { result } = await call("Runtime.evaluate", {
  expression: `axe.run(document, { runOnly: ${tags} }).then(({ violations, passes }) => JSON.stringify({
    passed: passes.length,
    violations: violations.map(({ id, help, nodes }) => ({ id, help, nodes: nodes.map((node) => node.html) })),
  }))`,
  awaitPromise: true,
  returnByValue: true,
});
const found = JSON.parse(result.value);
console.log(JSON.stringify(found, null, 1));
if (picture) {
  const { data } = await call("Page.captureScreenshot");
  writeFileSync(picture, Buffer.from(data, "base64"));
}
socket.close();
browser.kill();
process.exit(found.violations.length ? 1 : 0);
