// Drives the page within a frame of another page, as in a notebook: that page passes its requests on to the server.
// Arguments: address of the browser's protocol, address of the server's page, file of the framed page. Prints a JSON
// object of what it saw.
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { connect } from "./browser.mjs";

const [browser, page, file] = process.argv.slice(2);

const around = `<!DOCTYPE html><title>around</title><script type="module">
const html = await (await fetch("/framed")).text();
const frame = document.createElement("iframe");
frame.style.cssText = "width: 1200px; height: 700px";
const running = new Map();
addEventListener("message", async ({ data, source }) => {
  if (source !== frame.contentWindow) return;
  const { id, place, body, stop } = data.asperity;
  if (stop) { running.get(id)?.abort(); return; }
  const own = new AbortController();
  running.set(id, own);
  const send = part => frame.contentWindow.postMessage({ asperity: { id, ...part } }, "*");
  try {
    const response = await fetch("/ask/" + place, { method: "POST", body, signal: own.signal });
    send({ status: response.status });
    for (const line of (await response.text()).split("\\n")) if (line) send({ line });
  } catch {
    // Stopped.
  }
  send({ end: true });
});
frame.src = URL.createObjectURL(new Blob([html], { type: "text/html" }));
document.body.append(frame);
</script>`;

const server = createServer(async (request, response) => {
  if (request.url === "/framed") return response.end(readFileSync(file));
  if (!request.url.startsWith("/ask/")) {
    response.setHeader("content-type", "text/html");
    return response.end(around);
  }
  const parts = [];
  for await (const part of request) parts.push(part);
  const url = page + request.url.slice("/ask/".length);
  const answer = await fetch(url, { method: "POST", body: Buffer.concat(parts), headers: { origin: new URL(page).origin } });
  response.statusCode = answer.status;
  response.end(Buffer.from(await answer.arrayBuffer()));
});
await new Promise(done => server.listen(0, "127.0.0.1", done));

const { call, evaluate, until } = await connect(browser);
await call("Page.enable");
await call("Page.navigate", { url: `http://127.0.0.1:${server.address().port}/` });
const inside = "frames[0].document";
const idle = async () => {
  await new Promise(done => setTimeout(done, 250));
  await until(`${inside}.querySelector("#words")?.textContent && !${inside}.querySelector(".busy")`);
};
const seen = () => evaluate(`${inside}.querySelector("#words").textContent`);
const found = {};
await idle();
found.start = await seen();
await evaluate(`(() => {
  const row = [...${inside}.querySelectorAll(".control")].find(one => one.querySelector("label")?.textContent === "Peak force");
  const field = row.querySelector("input");
  field.value = "7.5";
  field.dispatchEvent(new Event("change"));
})()`);
await idle();
found.changed = await seen();
await evaluate(`${inside}.getElementById("undo").click()`);
await idle();
found.undone = await seen();
found.pictures = await evaluate(`${inside}.querySelectorAll(".picture svg").length`);
console.log(JSON.stringify(found));
process.exit(0);
