// Requests of the page within a frame: messages to the page around it, which answers with the lines.
const waiting = new Map();
let count = 0;
addEventListener("message", ({ data, source }) => {
  const { id, status, line, end } = (source === parent && data?.asperity) || {};
  const one = waiting.get(id);
  if (!one) return;
  if (status) one.begin(status);
  if (line !== undefined) one.lines.enqueue(new TextEncoder().encode(line.endsWith("\n") ? line : `${line}\n`));
  if (end) {
    waiting.delete(id);
    one.lines.close();
  }
});
globalThis.asperityPost = (place, body, signal) => new Promise((begin, fail) => {
  const id = ++count;
  let lines;
  const stream = new ReadableStream({ start: controller => { lines = controller; } });
  waiting.set(id, { lines, begin: status => begin(new Response(stream, { status })) });
  signal?.addEventListener("abort", () => {
    if (!waiting.delete(id)) return;
    parent.postMessage({ asperity: { id, stop: true } }, "*");
    const stopped = new DOMException("stopped", "AbortError");
    lines.error(stopped);
    fail(stopped);
  });
  parent.postMessage({ asperity: { id, place, body: JSON.stringify(body) } }, "*");
});
