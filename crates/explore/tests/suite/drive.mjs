// Drives the page in a browser by its debugging protocol: slider, undo, reload, knot, fault, drawn force, save.
// Arguments: address of the browser's protocol, address of the page. Prints a JSON object of what it saw.
import { connect } from "./browser.mjs";

const [browser, page] = process.argv.slice(2);
const { call, evaluate, until } = await connect(browser);
const idle = async () => {
  await new Promise(done => setTimeout(done, 250));
  await until(`document.querySelector("#words")?.textContent && !document.querySelector(".busy")`);
};
const row = label => `[...document.querySelectorAll(".control")].find(one => one.querySelector("label")?.textContent === ${JSON.stringify(label)})`;
const box = target => evaluate(`(() => { const { x, y, width, height } = (${target}).getBoundingClientRect(); return { x, y, width, height }; })()`);
const mouse = (type, x, y) => call("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 });
const drag = async (x, y, dx, dy) => {
  await mouse("mousePressed", x, y);
  for (let k = 1; k <= 10; k++) await mouse("mouseMoved", x + k * dx / 10, y + k * dy / 10);
  await mouse("mouseReleased", x + dx, y + dy);
  await idle();
};
const click = async id => { await evaluate(`document.getElementById("${id}").click()`); await idle(); };
const seen = async () => ({
  force: await evaluate(`${row("Peak force")}.querySelector("input").value`),
  words: await evaluate(`document.querySelector("#words").textContent`),
  hash: await evaluate("decodeURIComponent(location.hash)"),
});
const found = {};
const step = async name => { found[name] = await seen(); };

await call("Page.enable");
await call("Page.navigate", { url: `${page}#view=law,frf` });
await idle();
await step("start");
const slider = await box(`${row("Peak force")}.querySelector("input[type=range]")`);
await drag(slider.x + slider.width / 3, slider.y + slider.height / 2, slider.width / 3, 0);
await step("slid");
await click("undo");
await step("undone");
await click("redo");
await step("redone");
await call("Page.reload");
await idle();
await step("reloaded");
const knot = await box(`document.querySelectorAll(".handles circle")[1]`);
await drag(knot.x + knot.width / 2, knot.y + knot.height / 2, 0, -25);
await step("knot");
await evaluate(`(() => { const field = ${row("Rise time")}.querySelector("input"); field.value = "-1"; field.dispatchEvent(new Event("change")); })()`);
await until(`!document.getElementById("faults").hidden`);
found.fault = await evaluate(`document.getElementById("faults").textContent`);
await click("undo");
// A force is drawn with the pointer, one of its points moved by a key and typed, another removed.
await evaluate(`(() => {
  const field = [...document.querySelectorAll("#controls select")].find(one => one.selectedOptions[0]?.textContent === "gamma pulse");
  field.selectedIndex = [...field.options].findIndex(one => one.textContent === "drawn pulse");
  field.dispatchEvent(new Event("change"));
})()`);
await until(`document.querySelector(".pad polyline")`);
await idle();
const points = () => evaluate(`JSON.parse(new URLSearchParams(location.hash.slice(1)).getAll("set").find(one => one.startsWith("/excitation/points="))?.split("=")[1] ?? "null")`);
const pad = await box(`document.querySelector(".pad svg")`);
const place = (x, y) => [pad.x + x * pad.width, pad.y + y * pad.height];
await mouse("mousePressed", ...place(0.06, 0.6));
for (const [x, y] of [[0.1, 0.5], [0.2, 0.3], [0.3, 0.2], [0.36, 0.3], [0.5, 0.55], [0.6, 0.8]]) await mouse("mouseMoved", ...place(x, y));
await mouse("mouseReleased", ...place(0.6, 0.8));
await idle();
found.stroke = await points();
await step("drawn");
await click("undo");
found.before = await points();
await click("redo");
const key = async name => {
  await call("Input.dispatchKeyEvent", { type: "keyDown", key: name });
  await call("Input.dispatchKeyEvent", { type: "keyUp", key: name });
  await idle();
};
await evaluate(`document.querySelectorAll(".pad circle")[2].focus()`);
await key("ArrowUp");
found.raised = await points();
await key("Delete");
found.removed = await points();
await evaluate(`(() => { const field = document.querySelectorAll(".pad ~ .scrolled input")[3]; field.value = "17.5"; field.dispatchEvent(new Event("change")); })()`);
await idle();
await step("typed");
await call("Page.reload");
await idle();
await step("again");
await click("save");
await until(`document.getElementById("status").textContent.includes("written")`);
await step("saved");
console.log(JSON.stringify(found));
process.exit(0);
